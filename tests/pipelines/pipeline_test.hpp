// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "media.hpp"
#include "process.hpp"
#include "tests/expect_error.hpp"
#include "tests/has_element.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {

/// A folder of the test's own, and the scripts of pipelines/, run without a display.
class PipelineTest : public ::testing::Test {
 protected:
  /// The path of a file in the test's folder.
  std::string file(const std::string& name) const { return folder_ / name; }
  /// The path of a script.
  static std::string script(const std::string& name);
  /// Runs a script to its end and returns its exit status; fails the test after a timeout.
  int run(const std::string& name, const std::vector<std::string>& words,
          const Process::Environment& more = {}, double seconds = 120);
  /// Expects that a script ends with status 1 and says `text`.
  void expect_failure(const std::string& name, const std::vector<std::string>& words,
                      const std::string& text, const Process::Environment& more = {});
  /// Runs an endless pipeline until `path` has this many bytes, then ends it as Ctrl-C does. (The
  /// number of dropped live frames depends on the machine's load.) Fails the test if the pipeline
  /// or the sending `peer` ends before that.
  static void end_when_grown(Process& line, const std::string& path, uintmax_t bytes,
                             Process* peer = nullptr);
  /// The environment of scripts: no display, and `more`.
  static Process::Environment environment(const Process::Environment& more = {});

  std::string output_;  ///< of the last run

 private:
  TemporaryFolder folder_;
};

/// A SINK that keeps every frame as it is.
std::string raw_file(const std::string& path);

/// A mosaic of a decomposer: input and reflectance above, shading below, gray.
void expect_mosaic(const Image& frame);

}  // namespace inverse::testing
