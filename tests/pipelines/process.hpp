#pragma once
#include <sys/types.h>

#include <map>
#include <string>
#include <vector>

#include "tests/temporary_folder.hpp"

namespace inverse::testing {

/// A program that runs beside the test, with its children; ended with them at the latest by the
/// destructor.
class Process {
 public:
  using Environment = std::map<std::string, std::string>;  ///< an empty value unsets

  /// Starts it. stdout and stderr are kept together.
  explicit Process(const std::vector<std::string>& words, const Environment& environment = {});
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process();

  /// Its exit status, 128 + signal where one ended it, −1 where it still runs after `seconds`.
  int wait(double seconds);
  /// What Ctrl-C sends.
  void interrupt();
  bool running() { return wait(0) == -1; }
  /// What it has written so far.
  std::string output() const;

 private:
  pid_t pid_ = -1;
  int status_ = -1;
  TemporaryFolder folder_;
  const std::string log_ = folder_ / "log";
};

}  // namespace inverse::testing
