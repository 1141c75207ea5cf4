// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <map>
#include <string>
#include <vector>

namespace inverse::testing {

/// How a program ended and all that it wrote.
struct Ended {
  int status = -1;  ///< its exit status; −1 if a signal ended it: a crash, or a hang of two minutes
  std::string text;
};

/// Runs this very program (which has the runtime of a sanitizer where the plugin needs one) in a
/// process of its own, with more in its environment and these arguments.
Ended run_self(const std::map<std::string, std::string>& environment,
               const std::vector<std::string>& arguments);

/// Started with this option and a launch line, the program runs the line instead of the tests,
/// prints its errors, and exits with 1 if there are any.
inline constexpr const char* kLaunchOption = "--launch";

/// Started with this option, "null" or "ready", and a launch line, it runs the line twice, stopping
/// to that state in between, and prints "error" or "end" for each time.
inline constexpr const char* kRestartOption = "--restart";

/// Started with this option and a launch line, it marks a pixel of the element named "marked", runs
/// the line to its end or first error, and prints the names of the element messages, then "eos" or
/// "error".
inline constexpr const char* kMarkOption = "--mark";

/// Does what the options above ask for; −1 if they do not stand in the arguments.
int serve(int count, char** arguments);

}  // namespace inverse::testing
