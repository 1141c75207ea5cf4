// SPDX-License-Identifier: LGPL-2.1-or-later
// Symmetries: a mirrored frame has mirrored layers, brighter light brighter shading, and colors are
// interchangeable.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "methods.hpp"
#include "tests/extremes/problems/grid_problem.hpp"
#include "tests/reference/intrinsic/intrinsic_decomposition.hpp"
#include "tests/update_max.hpp"

namespace inverse::extremes {
namespace {

/// Paints in patches under a light with a border, and noise: 0.02 … 0.9.
Pixels picture(Extent extent, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  float paints[12][3];
  for (auto& paint : paints)
    for (float& channel : paint) channel = 0.06F + 0.9F * unit(random);
  Pixels pixels(4 * extent.pixels(), 1);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x)
      for (size_t c = 0; c < 3; ++c)
        pixels[4 * (size_t{y} * extent.width + x) + c] =
            (3 * x + 2 * y > extent.width ? 0.9F : 0.35F) * paints[(x / 13 + y / 9 * 5) % 12][c] *
            (0.97F + 0.06F * unit(random));
  return pixels;
}

Pixels mirrored(Extent extent, const Pixels& pixels, bool vertically) {
  Pixels result(pixels.size());
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      const uint32_t from = vertically ? (extent.height - 1 - y) * extent.width + x
                                       : y * extent.width + extent.width - 1 - x;
      std::copy_n(&pixels[4 * size_t{from}], 4, &result[4 * (size_t{y} * extent.width + x)]);
    }
  return result;
}

struct Apart {
  double rms = 0, most = 0;
};
/// How far two layers are apart, in log units. Black reflectance counts as 1e-6.
Apart apart(const Pixels& one, const Pixels& other) {
  Apart result;
  for (size_t i = 0; i < one.size(); ++i) {
    const double d = std::log(std::max(static_cast<double>(one[i]), 1e-6)) -
                     std::log(std::max(static_cast<double>(other[i]), 1e-6));
    result.rms += d * d / static_cast<double>(one.size());
    update_max(result.most, std::abs(d));
  }
  result.rms = std::sqrt(result.rms);
  return result;
}

/// Chromaticity and smoothness alone and nothing sampled: what no random number has a part in.
ThesisParams without_samples(Solver solver) {
  ThesisParams params;
  params.solver =
      solver == Solver::schwarz ? ThesisParams::Solver::schwarz : ThesisParams::Solver::pcg;
  params.samples = 0;
  params.w_clustering = 0;
  return params;
}

class Symmetry : public testing::Test {
 protected:
  const Lab lab_;
};

TEST_F(Symmetry, MirroredFramesHaveMirroredLayersWithoutSamples) {
  // 2^k m + 1 pixels: every level of the pyramid takes the mirrored pixels.
  const Extent extent{65, 49};
  const Pixels frame = picture(extent, 1);
  for (const bool vertically : {false, true}) {
    Method one(lab_, Solver::pcg, extent), other(lab_, Solver::pcg, extent);
    one.set(without_samples(Solver::pcg));
    other.set(without_samples(Solver::pcg));
    const Pixels a = one.decompose_unscaled(frame);
    const Pixels b = other.decompose_unscaled(mirrored(extent, frame, vertically));
    EXPECT_LT(apart(a, mirrored(extent, b, vertically)).most, 1e-4) << vertically;
  }
}

TEST_F(Symmetry, MirroredFramesHaveMirroredLayersInAlignedBlocks) {
  // The blocks of the first step lie at the origin, and the frame is made of whole ones.
  const Extent extent{64, 48};
  const Pixels frame = picture(extent, 2);
  for (const bool vertically : {false, true}) {
    ThesisParams params = without_samples(Solver::schwarz);
    params.levels = 1;
    params.irls_iterations = 1;
    params.pcg_iterations = 32;
    Method one(lab_, Solver::schwarz, extent), other(lab_, Solver::schwarz, extent);
    one.set(params);
    other.set(params);
    const Pixels a = one.decompose_unscaled(frame);
    const Pixels b = other.decompose_unscaled(mirrored(extent, frame, vertically));
    EXPECT_LT(apart(a, mirrored(extent, b, vertically)).most, 1e-4) << vertically;
  }
}

TEST_F(Symmetry, MirroredSystemsHaveMirroredSolutions) {
  // The multigrid's cells and aggregates start at the left: widths of 4 · 2^k are their own mirror
  // images.
  const Extent extent{64, 32};
  GridSystem system(extent), mirror(extent);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> exponent(-0.5, 0.5), unit(-0.5, 0.5);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      const uint32_t there = extent.width - 1 - x;
      const float right = std::pow(10.0F, exponent(random));
      system.right[system.at(x, y)] = right;
      if (there > 0) mirror.right[mirror.at(there - 1, y)] = right;
      mirror.down[mirror.at(there, y)] = system.down[system.at(x, y)] =
          std::pow(10.0F, exponent(random));
      mirror.f[mirror.at(there, y)] = system.f[system.at(x, y)] = unit(random);
      mirror.screen[mirror.cell(there, y)] = system.screen[system.cell(x, y)] = 1;
    }
  const auto one = cycles_on_device(lab_, system, 60).back();
  const auto other = cycles_on_device(lab_, mirror, 60).back();
  double worst = 0, most = 0;
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      update_max(worst, std::abs(one[system.at(x, y)] - other[system.at(extent.width - 1 - x, y)]));
      update_max(most, std::abs(one[system.at(x, y)]));
    }
  EXPECT_LT(worst, 1e-5 * most);
}

TEST_F(Symmetry, MirroredFramesHaveMirroredLayers) {
  const Extent extent{128, 64};
  const Pixels frame = picture(extent, 4);
  for (const bool vertically : {false, true}) {
    IntrinsicDecomposition::Params params;
    params.cycles = 32;
    params.tolerances.cycle = 0;
    Method one(lab_, Solver::multigrid, extent), other(lab_, Solver::multigrid, extent);
    one.set(params);
    other.set(params);
    const Pixels a = one.decompose_unscaled(frame);
    const Pixels b = other.decompose_unscaled(mirrored(extent, frame, vertically));
    const Apart difference = apart(a, mirrored(extent, b, vertically));
    printf("  mirrored: rms %.2e, most %.2e\n", difference.rms, difference.most);
    EXPECT_LT(difference.rms, 1e-3) << vertically;
    EXPECT_LT(difference.most, 1e-2) << vertically;
  }
}

TEST_F(Symmetry, BrighterLightIsBrighterShading) {
  // Far above the floors of 0.002 and 0.01 and below the clipping at 1e4.
  const Extent extent{96, 64};
  Pixels frame = picture(extent, 5);
  for (size_t i = 0; i < frame.size(); ++i)
    if (i % 4 < 3) frame[i] *= 512;
  IntrinsicDecomposition::Params params;
  params.tolerances.cycle = 0;
  Method method(lab_, Solver::multigrid, extent);
  method.set(params);
  const Pixels base = method.decompose_unscaled(frame);
  for (const int n : {1, 2, 4}) {
    Pixels brighter = frame;
    for (size_t i = 0; i < frame.size(); ++i)
      if (i % 4 < 3) brighter[i] = std::ldexp(frame[i], n);
    Method fresh(lab_, Solver::multigrid, extent);
    fresh.set(params);
    Pixels got = fresh.decompose_unscaled(brighter);
    for (size_t i = 3; i < got.size(); i += 4) got[i] = std::ldexp(got[i], -n);
    const Apart difference = apart(base, got);
    printf("  2^%d: rms %.2e, most %.2e\n", n, difference.rms, difference.most);
    EXPECT_LT(difference.most, 1e-3) << n;
  }
}

/// `pixels` with channel order[c] in the place of channel c.
Pixels permuted(const Pixels& pixels, const std::array<size_t, 3>& order) {
  Pixels result = pixels;
  for (size_t i = 0; i < pixels.size(); i += 4)
    for (size_t c = 0; c < 3; ++c) result[i + c] = pixels[i + order[c]];
  return result;
}

TEST_F(Symmetry, NoColorIsSpecialWithoutBins) {
  const Extent extent{96, 64};
  const Pixels frame = picture(extent, 6);
  IntrinsicDecomposition::Params params;
  params.prior.chroma_weight = 0;  // the grid of bins has axes
  params.tolerances.cycle = 0;
  Method method(lab_, Solver::multigrid, extent);
  method.set(params);
  const Pixels base = method.decompose_unscaled(frame);
  std::array<size_t, 3> order{0, 1, 2};
  while (std::next_permutation(order.begin(), order.end())) {
    Method fresh(lab_, Solver::multigrid, extent);
    fresh.set(params);
    const Pixels got = fresh.decompose_unscaled(permuted(frame, order));
    const Apart difference = apart(permuted(base, order), got);
    printf("  %zu%zu%zu: rms %.2e, most %.2e\n", order[0], order[1], order[2], difference.rms,
           difference.most);
    EXPECT_LT(difference.most, 1e-3);
  }
}

TEST_F(Symmetry, NoColorIsSpecialWhereTheDataTermDoesNotWeighThem) {
  // The data term weighs channels by their luminance; without it all are equal.
  const Extent extent{65, 49};
  const Pixels frame = picture(extent, 7);
  for (const Solver solver : {Solver::pcg, Solver::schwarz}) {
    ThesisParams params = without_samples(solver);
    params.w_data = 0;
    Method method(lab_, solver, extent);
    method.set(params);
    const Pixels base = method.decompose_unscaled(frame);
    std::array<size_t, 3> order{0, 1, 2};
    while (std::next_permutation(order.begin(), order.end())) {
      Method fresh(lab_, solver, extent);
      fresh.set(params);
      const Pixels got = fresh.decompose_unscaled(permuted(frame, order));
      EXPECT_LT(apart(permuted(base, order), got).most, 1e-4) << name_of(solver);
    }
  }
}

}  // namespace
}  // namespace inverse::extremes
