// SPDX-License-Identifier: LGPL-2.1-or-later
// Extreme weights of intrinsicdecomp: more cycles come closer to the solution for all user factors,
// over twelve decades of their products.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "method.hpp"
#include "tests/differences.hpp"

namespace inverse::extremes {
namespace {

/// Squares of strong colors with a third of their channels nearly black: strong coupling within
/// patches, weak coupling between them.
Pixels mosaic(Extent extent, uint32_t square) {
  std::mt19937 random(square);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<float> colors(3 * 4096);
  for (float& c : colors) c = unit(random) < 0.3F ? 0.01F : unit(random);
  Pixels pixels(4 * extent.pixels(), 1);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x)
      for (uint32_t c = 0; c < 3; ++c)
        pixels[4 * (size_t{y} * extent.width + x) + c] =
            colors[3 * ((x / square * 131 + y / square * 17) % 4096) + c];
  return pixels;
}

TEST(Weights, MoreCyclesComeCloserAtEveryCorner) {
  const Lab lab;
  const Extent extent{83, 70};
  const uint32_t squares[] = {8, 16, 64};
  int corner = 0;
  double early_sum = 0, late_sum = 0;
  for (const float a : {1e-3F, 1.0F, 1e3F})
    for (const float b : {1e-3F, 1.0F, 1e3F})
      for (const float v : {1e-3F, 1.0F, 1e3F})
        for (const float g : {0.0F, 1.0F, 1e3F}) {
          const Pixels frame = mosaic(extent, squares[corner++ % 3]);
          std::vector<std::vector<double>> results;
          for (const uint32_t cycles : {4U, 8U, 32U}) {
            Method method(lab, Solver::multigrid, extent);
            method.set(IntrinsicDecomposition::Params{
                .prior = {a, b, v, g}, .cycles = cycles, .tolerances = {.cycle = 0}});
            results.push_back(log_shading_of(method.decompose_unscaled(frame).intrinsic));
          }
          const double early = rms_difference(results[0], results[2]);
          const double late = rms_difference(results[1], results[2]);
          const std::string name = "reflectance " + std::to_string(a) + ", shading " +
                                   std::to_string(b) + ", value " + std::to_string(v) +
                                   ", chroma " + std::to_string(g);
          // Conditions of 1e8 and more: single precision cannot separate nearer solutions.
          EXPECT_LT(late, std::max(0.87 * early, 0.005)) << name;
          EXPECT_LT(early, 0.47) << name;
          early_sum += early;
          late_sum += late;
        }
  // 0.0640 and 0.0421 when this was written.
  EXPECT_LT(early_sum / corner, 0.0675);
  EXPECT_LT(late_sum / corner, 0.0443);
}

}  // namespace
}  // namespace inverse::extremes
