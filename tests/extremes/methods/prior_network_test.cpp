// SPDX-License-Identifier: LGPL-2.1-or-later
// Networks of intrinsicdecomp's prior that are saturated at either end, with extreme weights.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "method.hpp"
#include "tests/differences.hpp"
#include "tests/extremes/support/inputs.hpp"
#include "tests/kernels/intrinsic/prior_graph.hpp"

namespace inverse::extremes {
namespace {

/// All fields at one end.
PriorModelPtr constant(float bias) {
  network::Graph graph = testing::prior_graph(1, 0);
  const network::Node& last = graph.nodes.back();
  std::fill_n(graph.weights.begin() + static_cast<ptrdiff_t>(last.weights + last.weight_count()),
              last.channels, bias);
  return std::make_shared<const PriorModel>("constant", graph);
}

TEST(PriorNetwork, MoreCyclesComeCloserWhereItIsSaturated) {
  const Lab lab;
  const Extent extent{83, 70};
  const std::pair<const char*, PriorModelPtr> networks[] = {
      {"low", constant(-1e30F)},
      {"high", constant(1e30F)},
      {"any", testing::prior_model(2, 1e30F)},
      {"reflectance", testing::reflectance_model(3)}};
  Case one;
  one.width = extent.width;
  one.height = extent.height;
  one.seed = 5;
  const Pixels frame = frame_of(one, 0);
  double early_sum = 0, late_sum = 0;
  for (const auto& [name, network] : networks)
    for (const float a : {1e-3F, 1e3F})
      for (const float b : {1e-3F, 1e3F})
        for (const float v : {1e-3F, 1e3F}) {
          std::vector<std::vector<double>> results;
          for (const uint32_t cycles : {4U, 8U, 32U}) {
            Method method(lab, Solver::multigrid, extent);
            method.set(IntrinsicDecomposition::Params{.prior = {.reflectance_weight = a,
                                                                .shading_weight = b,
                                                                .value_weight = v,
                                                                .network = network},
                                                      .cycles = cycles,
                                                      .tolerances = {.cycle = 0}});
            const Pixels got = method.decompose_unscaled(frame).intrinsic;
            ASSERT_TRUE(std::all_of(got.begin(), got.end(),
                                    [](float c) { return std::isfinite(c) && c >= 0; }));
            results.push_back(log_shading_of(got));
          }
          const double early = rms_difference(results[0], results[2]);
          const double late = rms_difference(results[1], results[2]);
          EXPECT_LT(late, std::max(0.9 * early, 0.01))
              << name << ", reflectance " << a << ", shading " << b << ", value " << v;
          early_sum += early;
          late_sum += late;
        }
  EXPECT_LT(late_sum, 0.9 * early_sum);
}

}  // namespace
}  // namespace inverse::extremes
