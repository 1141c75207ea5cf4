// SPDX-License-Identifier: LGPL-2.1-or-later
#include "self_test.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace inverse::bundle {
namespace {

struct Counts {
  int passed = 0, failed = 0, skipped = 0;
};

constexpr const char* kFailed = ": exit status 1";  // of a program in which a test failed

/// Follows what a test program prints.
class Reader {
 public:
  explicit Reader(Counts& counts) : counts_(counts) {}

  void read(const std::string& line) {
    constexpr size_t kTag = 13;  // "[       OK ] "
    const std::string tag = line.substr(0, kTag);
    if (tag == "[ RUN      ] ") {
      running_ = line.substr(kTag);
      output_.clear();
    } else if (!running_.empty() && line.find(running_, kTag) == kTag) {
      if (tag == "[       OK ] ") return end("passed", counts_.passed, line.substr(kTag));
      if (tag == "[  FAILED  ] ") return end("FAILED", counts_.failed, line.substr(kTag), true);
      if (tag == "[  SKIPPED ] ") return end("skipped", counts_.skipped, line.substr(kTag), true);
    } else if (line.starts_with("device: ")) {
      if (!std::exchange(named_, true)) std::printf("%s\n", line.c_str());
    } else if (line.empty() || line[0] != '[') {
      output_ += line + '\n';
    }
  }
  /// The program ended badly, as `why` says. Returns whether that was in a test.
  bool close(const std::string& why) {
    const bool in_test = !running_.empty();
    end("FAILED", counts_.failed, (in_test ? running_ : "the test program") + why, true);
    return in_test;
  }
  /// Names of the tests that ran, as a negative filter.
  const std::string& done() const { return done_; }

 private:
  void end(const char* result, int& count, const std::string& text, bool with_output = false) {
    ++count;
    std::printf("%s %s\n%s", result, text.c_str(), with_output ? output_.c_str() : "");
    std::fflush(stdout);
    if (!running_.empty()) done_ += (done_.empty() ? "" : ":") + running_;
    running_.clear();
    output_.clear();
  }

  Counts& counts_;
  std::string running_, output_, done_;
  bool named_ = false;
};

/// Runs the program once. Returns how it ended; empty if properly.
std::string run_once(std::vector<std::string> command, const std::string& filter, Reader& reader) {
  command.push_back("--gtest_color=no");
  command.push_back("--gtest_filter=" + filter);
  std::vector<char*> words;
  words.reserve(command.size() + 1);
  for (std::string& word : command) words.push_back(word.data());
  words.push_back(nullptr);
  int ends[2];
  if (pipe(ends) != 0) return std::string(": ") + std::strerror(errno);
  const pid_t child = fork();
  if (child < 0) return std::string(": ") + std::strerror(errno);
  if (child == 0) {
    dup2(ends[1], STDOUT_FILENO);
    dup2(ends[1], STDERR_FILENO);
    close(ends[0]);
    close(ends[1]);
    execv(words[0], words.data());
    std::perror(words[0]);
    _exit(127);
  }
  close(ends[1]);
  FILE* output = fdopen(ends[0], "r");
  char* line = nullptr;
  size_t size = 0;
  for (ssize_t length; (length = getline(&line, &size, output)) > 0;)
    reader.read(std::string(line, length - (line[length - 1] == '\n')));
  std::free(line);
  std::fclose(output);
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status)) return std::string(": ") + strsignal(WTERMSIG(status));
  const int code = WEXITSTATUS(status);
  return code > 0 ? ": exit status " + std::to_string(code) : "";
}

/// A filter without the tests named in `done`.
std::string without(const std::string& filter, const std::string& done) {
  if (done.empty()) return filter;
  const bool negative = filter.find('-') != std::string::npos;
  return filter + (negative ? ':' : '-') + done;
}

}  // namespace

int self_test(const std::vector<std::string>& command, const std::string& filter) {
  Counts counts;
  Reader reader(counts);
  // Tests named WarmUp need a process in which no others ran.
  const std::vector<std::string> filters =
      filter.empty() ? std::vector<std::string>{"*-*WarmUp.*", "*WarmUp.*"}
                     : std::vector<std::string>{filter};
  for (const std::string& each : filters) {
    for (bool again = true; again;) {
      const int failed = counts.failed;
      std::string why = run_once(command, without(each, reader.done()), reader);
      if (why == kFailed && counts.failed > failed) why.clear();
      again = !why.empty() && reader.close(why);
    }
  }
  std::printf("%d passed, %d failed", counts.passed, counts.failed);
  if (counts.skipped > 0) std::printf(", %d skipped", counts.skipped);
  std::printf("\n");
  return counts.failed > 0 || counts.passed == 0;
}

}  // namespace inverse::bundle
