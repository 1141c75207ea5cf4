// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <sys/types.h>

#include <map>
#include <string>
#include <vector>

#include "tests/temporary_folder.hpp"

namespace inverse::testing {

/// A program with its children, running in parallel with the test; the destructor ends it.
class Process {
 public:
  using Environment = std::map<std::string, std::string>;  ///< an empty value unsets

  /// Starts it. stdout and stderr are kept together.
  explicit Process(const std::vector<std::string>& words, const Environment& environment = {});
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process();

  /// Its exit status; 128 + signal if a signal ended it; −1 if it still runs after `seconds`.
  int wait(double seconds);
  /// Sends SIGINT, as Ctrl-C does.
  void interrupt();
  bool running() { return wait(0) == -1; }
  /// Its output so far.
  std::string output() const;

 private:
  pid_t pid_ = -1;
  int status_ = -1;
  TemporaryFolder folder_;
  const std::string log_ = folder_ / "log";
};

}  // namespace inverse::testing
