// The ladder of stiff systems: accuracy of solutions in single precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/extremes/support/problem.hpp"

namespace inverse::extremes {
namespace {

class Conditions : public testing::TestWithParam<Solver> {};

TEST_P(Conditions, NoMoreDigitsAreLostThanTheConditionPredicts) {
  const Lab lab;
  double least = 1e300, most = 0;
  for (const Problem& problem : ladder()) {
    if (problem.solver != GetParam()) continue;
    const Outcome outcome = judge(problem, lab);
    EXPECT_TRUE(outcome.finite) << problem.name;
    EXPECT_GE(outcome.digits_preconditioned, predicted_digits(problem.solver, outcome))
        << problem.name << ", condition " << outcome.condition;
    least = std::min(least, outcome.condition);
    most = std::max(most, outcome.condition);
  }
  EXPECT_LT(least, 1e3) << "the ladder starts at well-conditioned systems";
  EXPECT_GT(most, 1e8) << "and ends at hopeless ones";
}

INSTANTIATE_TEST_SUITE_P(All, Conditions,
                         testing::Values(Solver::multigrid, Solver::pcg, Solver::schwarz,
                                         Solver::global_thesis),
                         [](const auto& info) {
                           std::string name = name_of(info.param);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(Dense, KnowsSpectrumAndSolutionOfAChain) {
  // The chain 2, −1 of n: eigenvalues 2 − 2 cos(k π/(n + 1)).
  constexpr size_t n = 40;
  const double pi = std::acos(-1.0);
  Dense chain(n);
  std::vector<double> b(n, 0), ones(n, 1);
  for (size_t i = 0; i < n; ++i) {
    chain.at(i, i) = 2;
    if (i + 1 < n) chain.at(i, i + 1) = chain.at(i + 1, i) = -1;
  }
  b.front() = b.back() = 1;
  const std::vector<double> values = eigenvalues(chain);
  for (size_t k = 0; k < n; ++k)
    EXPECT_NEAR(values[k], 2 - 2 * std::cos(static_cast<double>(k + 1) * pi / (n + 1)), 1e-12);
  EXPECT_GT(digits_kept(solve(chain, b), ones), 12);
  EXPECT_GT(digits_kept(plain_single_precision(chain, b, 200), ones), 4);
  EXPECT_EQ(digits_kept(std::vector<double>(n, NAN), ones), 0);
}

}  // namespace
}  // namespace inverse::extremes
