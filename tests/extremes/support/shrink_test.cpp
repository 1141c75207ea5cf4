// SPDX-License-Identifier: LGPL-2.1-or-later
// The shrinking itself: it must arrive at the smallest case, and say what it found.
#include <gtest/gtest.h>

#include "inputs.hpp"

namespace inverse::extremes {
namespace {

TEST(Shrinking, FindsTheSmallestCaseThatStillFails) {
  // Fails from 5 × 3 pixels and the second frame on, when there are NaNs.
  const auto check = [](const Case& one) -> std::optional<std::string> {
    const bool fails =
        one.width >= 5 && one.height >= 3 && one.frames >= 2 && (one.faults >> kNan & 1U) != 0;
    return fails ? std::optional<std::string>("too much") : std::nullopt;
  };
  const Case start{Solver::pcg, 61, 47, 4, 1234, 0x7FFF, 0x3F};
  ASSERT_TRUE(check(start));
  const Shrunk small = shrink(start, "at first", check);
  EXPECT_EQ(small.smallest.text(), (Case{Solver::pcg, 5, 3, 2, 1, 1U << kNan, 0}).text());
  EXPECT_EQ(small.reason, "too much");
  EXPECT_LT(small.runs, 100);
}

TEST(Shrinking, StopsAfterSoManyRunsAndKeepsAFailingCase) {
  int runs = 0;
  const auto check = [&](const Case& one) -> std::optional<std::string> {
    ++runs;
    return one.width > 1 ? std::optional<std::string>("wide") : std::nullopt;
  };
  const Shrunk small = shrink({Solver::pcg, 4000, 1, 1, 1, 0, 0}, "at first", check, 7);
  EXPECT_EQ(runs, 7);
  EXPECT_GT(small.smallest.width, 1U);
}

TEST(Shrinking, CasesAreDescribedWholeAndReadBack) {
  for (uint32_t seed = 0; seed < 50; ++seed) {
    const Case one = random_case(kSolvers[seed % 5], seed, 64);
    EXPECT_EQ(parse_case(one.text()), one) << one.text();
    EXPECT_LE(std::max(one.width, one.height), 64U);
  }
  EXPECT_THROW(parse_case("pcg 0x5 frames=1 seed=1 faults=0x0 knobs=0x0"), std::invalid_argument);
  EXPECT_THROW(parse_case("magic 5x5 frames=1 seed=1 faults=0x0 knobs=0x0"), std::invalid_argument);
}

TEST(Shrinking, RandomCasesReachEveryFaultAndKnob) {
  for (const Solver solver : {Solver::pcg, Solver::global}) {
    uint32_t faults = 0, knobs = 0;
    for (uint32_t seed = 1; seed <= 30; ++seed) {
      faults |= random_case(solver, seed, 64).faults;
      knobs |= random_case(solver, seed, 64).knobs;
    }
    EXPECT_EQ(faults, (1U << faults_for(solver)) - 1) << name_of(solver);
    EXPECT_EQ(knobs, (1U << kKnobs) - 1) << name_of(solver);
  }
  EXPECT_EQ(faults_for(Solver::global), static_cast<uint32_t>(kFaults));
}

}  // namespace
}  // namespace inverse::extremes
