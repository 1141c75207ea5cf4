// SPDX-License-Identifier: LGPL-2.1-or-later
// Command lines of benchmarks and of training, as a table of options.
#pragma once

#include <cstdio>
#include <exception>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace inverse::bench {

/// Action of an option: receives the next word if `takes_value`; false rejects the word.
struct Option {
  bool takes_value;
  std::function<bool(const char* value)> take;
};
using Options = std::map<std::string, Option>;

inline Option integer(int& field) {
  return {true, [&field](const char* value) { return sscanf(value, "%d", &field) == 1; }};
}
inline Option number(float& field) {
  return {true, [&field](const char* value) { return sscanf(value, "%f", &field) == 1; }};
}
inline Option number(double& field) {
  return {true, [&field](const char* value) { return sscanf(value, "%lf", &field) == 1; }};
}
inline Option text(std::string& field) {
  return {true, [&field](const char* value) { return !(field = value).empty(); }};
}
inline Option flag(std::function<void()> set) {
  return {false, [set = std::move(set)](const char*) { return set(), true; }};
}

/// Parses a command line; prints a message and returns false for unknown words. `source` is the
/// file whose head lists the options. Words that are not options go to `files`, if given.
inline bool read(const Options& options, int argc, char** argv, const char* source,
                 std::vector<std::string>* files = nullptr) {
  for (int i = 1; i < argc; ++i) {
    if (files && argv[i][0] != '-') {
      files->emplace_back(argv[i]);
      continue;
    }
    const auto option = options.find(argv[i]);
    const char* name = argv[i];
    const bool known = option != options.end() && (!option->second.takes_value || ++i < argc);
    if (known && option->second.take(argv[i])) continue;
    fprintf(stderr, "%s is not understood; the head of %s lists the options\n", name, source);
    return false;
  }
  return true;
}

/// main() of a benchmark `name`: what `run(argc, argv)` returns; 1, with a message, if it throws.
inline int run_main(const char* name, int (*run)(int, char**), int argc, char** argv) try {
  return run(argc, argv);
} catch (const std::exception& error) {
  fprintf(stderr, "%s: %s\n", name, error.what());
  return 1;
}

}  // namespace inverse::bench
