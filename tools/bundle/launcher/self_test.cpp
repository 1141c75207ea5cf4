// SPDX-License-Identifier: LGPL-2.1-or-later
#include "self_test.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>

namespace inverse::bundle {
namespace {

using Names = std::vector<std::string>;

/// What all processes found.
class Results {
 public:
  void add(int Results::*count, const std::string& text, const std::string& output) {
    const std::lock_guard lock(mutex_);
    ++(this->*count);
    std::printf("%s\n%s", text.c_str(), output.c_str());
    std::fflush(stdout);
  }
  void name_device(const std::string& line) {
    const std::lock_guard lock(mutex_);
    if (!std::exchange(named_, true)) std::printf("%s\n", line.c_str());
  }
  int passed = 0, failed = 0, skipped = 0;

 private:
  std::mutex mutex_;
  bool named_ = false;
};

constexpr const char* kFailed = ": exit status 1";  // of a program in which a test failed

/// Follows what a test program prints.
class Reader {
 public:
  explicit Reader(Results& results) : results_(results) {}

  void read(const std::string& line) {
    constexpr size_t kTag = 13;  // "[       OK ] "
    const std::string tag = line.substr(0, kTag);
    if (tag == "[ RUN      ] ") {
      running_ = line.substr(kTag);
      output_.clear();
    } else if (!running_.empty() && line.find(running_, kTag) == kTag) {
      const std::string text = line.substr(kTag);
      if (tag == "[       OK ] ") return end(&Results::passed, "passed " + text, "");
      if (tag == "[  FAILED  ] ") {
        ++failed_;
        return end(&Results::failed, "FAILED " + text, output_);
      }
      if (tag == "[  SKIPPED ] ") return end(&Results::skipped, "skipped " + text, output_);
    } else if (line.starts_with("device: ")) {
      results_.name_device(line);
    } else if (line.empty() || line[0] != '[') {
      output_ += line + '\n';
    }
  }
  /// The program ended badly, as `why` says. Returns whether that was in a test.
  bool close(const std::string& why) {
    const bool in_test = !running_.empty();
    end(&Results::failed, "FAILED " + (in_test ? running_ : "the test program") + why, output_);
    return in_test;
  }
  /// Those of `names` that have not run.
  Names rest_of(const Names& names) const {
    Names rest;
    for (const std::string& name : names)
      if (!done_.contains(name)) rest.push_back(name);
    return rest;
  }
  int failed() const { return failed_; }

 private:
  void end(int Results::*count, const std::string& text, const std::string& output) {
    results_.add(count, text, output);
    done_.insert(std::exchange(running_, ""));
    output_.clear();
  }

  Results& results_;
  std::string running_, output_;
  std::set<std::string> done_;
  int failed_ = 0;
};

/// Runs a program and hands over each line that it prints. Returns how it ended; empty if properly.
std::string run(std::vector<std::string> command, const std::function<void(std::string)>& read) {
  std::vector<char*> words;
  words.reserve(command.size() + 1);
  for (std::string& word : command) words.push_back(word.data());
  words.push_back(nullptr);
  int ends[2];
  // No other process of ours may hold the writing end.
  if (pipe2(ends, O_CLOEXEC) != 0) return std::string(": ") + std::strerror(errno);
  const pid_t child = fork();
  if (child < 0) {
    const std::string why = std::strerror(errno);
    close(ends[0]);
    close(ends[1]);
    return ": " + why;
  }
  if (child == 0) {
    dup2(ends[1], STDOUT_FILENO);
    dup2(ends[1], STDERR_FILENO);
    execv(words[0], words.data());
    std::perror(words[0]);
    _exit(127);
  }
  close(ends[1]);
  FILE* output = fdopen(ends[0], "r");
  char* line = nullptr;
  size_t size = 0;
  for (ssize_t length; (length = getline(&line, &size, output)) > 0;)
    read(std::string(line, length - (line[length - 1] == '\n')));
  std::free(line);
  std::fclose(output);
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status)) return std::string(": ") + strsignal(WTERMSIG(status));
  const int code = WEXITSTATUS(status);
  return code > 0 ? ": exit status " + std::to_string(code) : "";
}

/// Names of the tests that a filter selects. A program that lists none counts as failed.
Names list_tests(std::vector<std::string> command, const std::string& filter, Results& results) {
  command.insert(command.end(), {"--gtest_list_tests", "--gtest_filter=" + filter});
  Names names;
  std::string suite, output;
  const std::string why = run(std::move(command), [&](std::string line) {
    output += line + '\n';
    line = line.substr(0, line.find("  #"));  // parameters
    if (line.starts_with("  "))
      names.push_back(suite + line.substr(2));
    else if (line.ends_with('.'))
      suite = line;
  });
  if (!why.empty()) results.add(&Results::failed, "FAILED the test program" + why, output);
  return names;
}

/// Runs tests in one process, and those after a test that ends it in another.
void run_tests(std::vector<std::string> command, const Names& names, Results& results) {
  Reader reader(results);
  command.insert(command.end(), {"--gtest_color=no", ""});
  for (Names rest = names; !rest.empty();) {
    command.back() = "--gtest_filter=";
    for (const std::string& name : rest) command.back() += name + ':';
    const int failed = reader.failed();
    std::string why = run(command, [&](const std::string& line) { reader.read(line); });
    if (why == kFailed && reader.failed() > failed) why.clear();
    rest = reader.rest_of(names);
    if (!why.empty() && reader.close(why)) {
      rest = reader.rest_of(names);
      continue;
    }
    for (const std::string& name : rest)
      results.add(&Results::failed, "FAILED " + name + ": did not run", "");
    return;
  }
}

}  // namespace

int self_test(const std::vector<std::string>& command, const std::string& filter) {
  // Tests named WarmUp need a process in which no others ran.
  std::vector<Names> groups(std::clamp(std::thread::hardware_concurrency(), 1U, 16U));
  Names alone;
  Results results;
  size_t next = 0;
  for (const std::string& name : list_tests(command, filter.empty() ? "*" : filter, results))
    (name.find("WarmUp.") != std::string::npos ? alone : groups[next++ % groups.size()])
        .push_back(name);
  std::vector<std::thread> threads;
  for (const Names& group : groups)
    threads.emplace_back([&] { run_tests(command, group, results); });
  for (std::thread& thread : threads) thread.join();
  run_tests(command, alone, results);
  std::printf("%d passed, %d failed", results.passed, results.failed);
  if (results.skipped > 0) std::printf(", %d skipped", results.skipped);
  std::printf("\n");
  return results.failed > 0 || results.passed == 0;
}

}  // namespace inverse::bundle
