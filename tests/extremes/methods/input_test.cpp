// SPDX-License-Identifier: LGPL-2.1-or-later
// Bad input, one by one and in seeded mixtures, for every solver: finite, consistent layers.
#include <gtest/gtest.h>

#include <limits>

#include "check.hpp"

namespace inverse::extremes {
namespace {

class Inputs : public testing::TestWithParam<Solver> {
 protected:
  static const Lab& lab() {
    static const Lab lab;
    return lab;
  }
};

TEST_P(Inputs, EveryFaultByItself) {
  check_each_fault(check_with(lab()), GetParam(), 3, {{1, 1}, {2, 3}, {31, 18}, {1, 200}});
}

TEST_P(Inputs, MixturesOfFaultsAndParameters) {
  const auto failure = first_failure(GetParam(), 1, 40, 48, check_with(lab()));
  EXPECT_FALSE(failure) << *failure;
}

TEST(InputsThatFailed, CasesPass) {
  const Lab lab;
  for (const char* text : {
           // Black and 1e4 above and below: single precision lost what else holds the row, and its
           // block was solved for a pivot of 0.
           "multigrid 2x31 frames=1 seed=57 faults=0x80 knobs=0x0",
           // Light that is clipped after its tint is out.
           "global 1x2 frames=1 seed=1 faults=0x200 knobs=0x0",
       }) {
    const auto wrong = check_with(lab)(parse_case(text));
    EXPECT_FALSE(wrong) << text << ": " << *wrong;
  }
}

TEST(InputsThatFailed, TheLargestFloatIsNotInfinite) {
  const Lab lab;
  constexpr float kLargest = std::numeric_limits<float>::max();
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  Method method(lab, Solver::global_thesis, {1, 1});
  method.decompose({kLargest, kInfinite, 1e5F, 1});
  const Pixels taken = lab.download(method.global_thesis().image().buffer);
  EXPECT_EQ(taken, (Pixels{65504, 1, 65504, 1}));
}

INSTANTIATE_TEST_SUITE_P(All, Inputs, testing::ValuesIn(kSolvers), solver_name);

}  // namespace
}  // namespace inverse::extremes
