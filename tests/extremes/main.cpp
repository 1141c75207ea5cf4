// SPDX-License-Identifier: LGPL-2.1-or-later
// extremes [--report FILE | --case TEXT | --search SOLVER FIRST COUNT] [GoogleTest's options]
//
// The stability suite. --case TEXT runs one random case, as a failure names it. --search runs COUNT
// of a solver's cases from seed FIRST on and shrinks the first that fails. --report FILE runs
// the stiff systems instead of the tests and writes condition numbers against digits
// kept, for every solver, as JSON.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>

#include "common/error.hpp"
#include "tests/extremes/methods/check.hpp"
#include "tests/extremes/support/problem.hpp"

namespace inverse::extremes {
namespace {

int report(const char* path) {
  const Lab lab;
  FILE* file = fopen(path, "w");
  if (!file) {
    perror(path);
    return 1;
  }
  printf("%-10s %-40s %9s %9s %6s %6s\n", "solver", "system", "condition", "scaled", "plain",
         "digits");
  fprintf(file, "{\"device\": \"%s\", \"cases\": [", lab.device()->name().c_str());
  const char* separator = "";
  for (const Problem& problem : stiff_problems()) {
    const Outcome outcome = judge(problem, lab);
    printf("%-10s %-40s %9.2g %9.2g %6.2f %6.2f\n", name_of(problem.solver), problem.name.c_str(),
           outcome.condition, outcome.condition_preconditioned, outcome.digits_plain,
           outcome.digits_preconditioned);
    fprintf(file,
            "%s\n  {\"name\": \"%s: %s\", \"solver\": \"%s\", \"system\": \"%s\", "
            "\"condition\": %.4g, \"condition_preconditioned\": %.4g, \"digits_plain\": %.3f, "
            "\"digits_preconditioned\": %.3f, \"iterations\": %d}",
            separator, name_of(problem.solver), problem.name.c_str(), name_of(problem.solver),
            problem.name.c_str(), outcome.condition, outcome.condition_preconditioned,
            outcome.digits_plain, outcome.digits_preconditioned, problem.iterations);
    separator = ",";
  }
  fprintf(file, "\n]}\n");
  return fclose(file) == 0 ? 0 : 1;
}

int search(const std::string& solver, const char* first, const char* count) {
  const Lab lab;
  const Solver kind = parse_case(solver + " 1x1 frames=1 seed=1 faults=0x0 knobs=0x0").solver;
  const auto failure = first_failure(kind, static_cast<uint32_t>(std::stoul(first)),
                                     static_cast<uint32_t>(std::stoul(count)), 48, check_with(lab));
  printf("%s\n", failure ? failure->c_str() : "nothing is wrong");
  return failure ? 1 : 0;
}

int run_case(const char* text) {
  const Lab lab;
  const Case one = parse_case(text);
  const auto wrong = check_with(lab)(one);
  printf("%s\n", wrong ? wrong->c_str() : "nothing is wrong");
  return wrong ? 1 : 0;
}

}  // namespace
}  // namespace inverse::extremes

int main(int count, char** words) {
  try {
    if (count == 3 && strcmp(words[1], "--report") == 0) return inverse::extremes::report(words[2]);
    if (count == 3 && strcmp(words[1], "--case") == 0) return inverse::extremes::run_case(words[2]);
    if (count == 5 && strcmp(words[1], "--search") == 0)
      return inverse::extremes::search(words[2], words[3], words[4]);
  } catch (const std::exception& error) {
    fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  testing::InitGoogleTest(&count, words);
  return RUN_ALL_TESTS();
}
