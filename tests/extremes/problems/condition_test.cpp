// SPDX-License-Identifier: LGPL-2.1-or-later
// Stiff systems of increasing condition: accuracy of solutions in single precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/extremes/support/problem.hpp"

namespace inverse::extremes {
namespace {

/// Digits reached, the min over three variants on llvmpipe, rounded down.
const std::map<std::string, double> kDigits{
    {"multigrid: edges over 0 decades", 7.0},
    {"multigrid: edges over 2 decades", 6.6},
    {"multigrid: edges over 4 decades", 5.3},
    {"multigrid: edges over 6 decades", 2.5},
    {"multigrid: edges over 8 decades", 1.7},
    {"multigrid: edges over 12 decades", 0.9},
    {"multigrid: patches of 100 that 1 joins", 6.6},
    {"multigrid: patches of 10000 that 1 joins", 6.7},
    {"multigrid: patches of 1e+06 that 1 joins", 6.7},
    {"multigrid: cells held by 1000", 2.9},
    {"multigrid: cells held by 0.01", 6.4},
    {"multigrid: cells held by 0.0001", 6.3},
    {"multigrid: stroke of 1000 on a cell", 6.6},
    {"multigrid: stroke of 100000 on a cell", 6.6},
    {"pcg: defaults", 6.8},
    {"pcg: epsilon 0.1 at zero gradient", 6.7},
    {"pcg: epsilon 0.01 at zero gradient", 6.6},
    {"pcg: epsilon 0.001 at zero gradient", 6.6},
    {"pcg: epsilon 0.0001 at zero gradient", 6.5},
    {"pcg: epsilon 1e-05 at zero gradient", 6.5},
    {"pcg: epsilon 1e-06 at zero gradient", 2.5},
    {"pcg: p 2 at zero gradient", 6.7},
    {"pcg: p 1, epsilon 1e-06 at zero gradient", 6.5},
    {"pcg: p 0.3 at zero gradient", 6.6},
    {"pcg: p 0.01 at zero gradient", 6.6},
    {"pcg: stroke of 0.01", 5.8},
    {"pcg: stroke of 1000", 6.9},
    {"pcg: stroke of 100000", 6.8},
    {"pcg: strokes of 1e-1 and 1e5", 6.6},
    {"pcg: data 1e6", 6.8},
    {"pcg: reflectance 1e4, shading 1e-2", 0.7},
    {"pcg: shading 1e6, reflectance 1e-6", 7.0},
    {"pcg: edges over 6 decades", 6.6},
    {"pcg: edges over 12 decades", 1.2},
    {"schwarz: defaults", 6.8},
    {"schwarz: epsilon 0.1 at zero gradient", 7.0},
    {"schwarz: epsilon 0.01 at zero gradient", 6.8},
    {"schwarz: epsilon 0.001 at zero gradient", 6.6},
    {"schwarz: epsilon 0.0001 at zero gradient", 6.4},
    {"schwarz: epsilon 1e-05 at zero gradient", 6.3},
    {"schwarz: epsilon 1e-06 at zero gradient", 3.6},
    {"schwarz: p 2 at zero gradient", 6.9},
    {"schwarz: p 1, epsilon 1e-06 at zero gradient", 6.2},
    {"schwarz: p 0.3 at zero gradient", 6.6},
    {"schwarz: p 0.01 at zero gradient", 6.7},
    {"schwarz: stroke of 0.01", 5.3},
    {"schwarz: stroke of 1000", 6.9},
    {"schwarz: stroke of 100000", 6.9},
    {"schwarz: strokes of 1e-1 and 1e5", 6.7},
    {"schwarz: data 1e6", 6.6},
    {"schwarz: reflectance 1e4, shading 1e-2", 1.0},
    {"schwarz: shading 1e6, reflectance 1e-6", 6.9},
    {"schwarz: edges over 6 decades", 6.8},
    {"schwarz: edges over 12 decades", 3.9},
    {"global-thesis: defaults", 5.8},
    {"global-thesis: epsilons 1 at zero gradient", 4.6},
    {"global-thesis: epsilons 0.01 at zero gradient", 6.1},
    {"global-thesis: epsilons 0.001 at zero gradient", 5.9},
    {"global-thesis: epsilons 0.0001 at zero gradient", 5.7},
    {"global-thesis: data 1", 5.2},
    {"global-thesis: data 1e+06", 3.7},
    {"global-thesis: p 0", 5.3},
    {"global-thesis: p 2", 6.1},
    {"global-thesis: light over 2 decades", 6.0},
    {"global-thesis: light over 4 decades", 5.9},
    {"global-thesis: light over 8 decades", 6.0},
    {"global-thesis: sparsity 1e4", 5.9},
    {"global-thesis: smoothness 1e4", 4.5},
    {"global-thesis: clusters 1e-4", 4.5},
    {"global-thesis: clusters 1e-4, data 1e6", 2.5},
    {"global-thesis: clusters 1e-4, epsilons 1e-4 at zero gradient", 2.0},
    {"global-thesis: clusters 1e-4, smoothness 1e6", 2.5},
    {"global-thesis: base colors that are nearly one", 5.7},
    {"global-thesis: negative light, penalty 1000", 5.8},
    {"global-thesis: negative light, penalty 1e+06", 5.5},
};

class Conditions : public testing::TestWithParam<Solver> {};

TEST_P(Conditions, SolutionsKeepTheirDigits) {
  const Lab lab;
  double smallest = 1e300, largest = 0;
  for (const Problem& problem : stiff_problems()) {
    if (problem.solver != GetParam()) continue;
    const Outcome outcome = judge(problem, lab);
    EXPECT_TRUE(outcome.finite) << problem.name;
    const auto digits = kDigits.find(std::string(name_of(problem.solver)) + ": " + problem.name);
    ASSERT_NE(digits, kDigits.end()) << problem.name << " has no line in the table";
    EXPECT_GE(outcome.digits_preconditioned, digits->second - 0.3) << problem.name;
    smallest = std::min(smallest, outcome.condition);
    largest = std::max(largest, outcome.condition);
  }
  EXPECT_LT(smallest, 1e3) << "the first systems are well-conditioned";
  EXPECT_GT(largest, 1e8) << "and ends at hopeless ones";
}

INSTANTIATE_TEST_SUITE_P(All, Conditions,
                         testing::Values(Solver::multigrid, Solver::pcg, Solver::schwarz,
                                         Solver::global_thesis),
                         solver_name);

TEST(Dense, SpectrumAndSolutionOfAChain) {
  // The chain 2, −1 of n: eigenvalues 2 − 2 cos(k π/(n + 1)).
  constexpr size_t n = 40;
  const double pi = std::acos(-1.0);
  Eigen::MatrixXd chain = Eigen::MatrixXd::Zero(n, n);
  std::vector<double> b(n, 0), ones(n, 1);
  for (size_t i = 0; i < n; ++i) {
    chain(i, i) = 2;
    if (i + 1 < n) chain(i, i + 1) = chain(i + 1, i) = -1;
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
