// SPDX-License-Identifier: LGPL-2.1-or-later
// Scenes and means for the tests of intrinsicdecomp.
#pragma once
#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "kernels/image/pack4.hpp"
#include "kernels/image/pyramid.hpp"
#include "kernels/intrinsic/intrinsic_decomposition.hpp"
#include "tests/differences.hpp"
#include "tests/kernels/gpu_fixture.hpp"
#include "tests/reference/intrinsic/intrinsic_decomposition.hpp"
#include "tests/reference/intrinsic/multigrid.hpp"
#include "tests/reference/intrinsic/output_scale.hpp"

namespace inverse::testing {

/// Tiles of colors of few chromas and many values, under a light with a border: has all kinds of
/// edges.
inline Pixels scene(Extent extent, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<std::array<float, 3>> paints(24);
  for (auto& paint : paints) {
    const float value = 0.05F + 0.9F * unit(random);
    for (float& c : paint) c = value * (0.3F + 0.7F * unit(random));
  }
  Pixels pixels(extent.pixels() * 4, 1);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      const float light = (x + 2 * y > extent.width ? 0.9F : 0.35F) *
                          (1 - 0.4F * static_cast<float>(y) / static_cast<float>(extent.height));
      const auto& paint = paints[((x / 23) * 7 + (y / 19) * 11) % paints.size()];
      for (size_t c = 0; c < 3; ++c)
        pixels[4 * (static_cast<size_t>(y) * extent.width + x) + c] =
            light * paint[c] * (0.97F + 0.06F * unit(random));
    }
  return pixels;
}

inline std::vector<double> rgb_of(const Pixels& pixels) {
  std::vector<double> rgb;
  for (size_t i = 0; i < pixels.size(); i += 4)
    for (size_t c = 0; c < 3; ++c)
      rgb.push_back(std::isinf(pixels[i + c]) && pixels[i + c] > 0
                        ? 1.0
                        : static_cast<double>(pixels[i + c]));
  return rgb;
}

inline reference::Guide guide_of(Extent extent, const Pixels& pixels,
                                 const reference::LightColor& light = {}) {
  return reference::make_guide(rgb_of(pixels).data(), int(extent.width), int(extent.height), light);
}

/// The place of a pixel's k-th number in a buffer that has `stride` of each, in packs of four.
inline size_t packed(Extent extent, uint32_t x, uint32_t y, size_t stride = 1, size_t k = 0) {
  return 4 * (stride * (size_t{y} * pack4_count(extent.width) + x / 4) + k) + x % 4;
}

/// Root mean square difference of ln S of two planes of (R, S).
inline double shading_distance(const Pixels& one, const Pixels& other) {
  return rms_difference(log_shading_of(one), log_shading_of(other));
}

class IntrinsicTest : public GpuTest {
 protected:
  /// Buffers for what the prior of a frame writes.
  EdgePrior::Target prior_target(Extent extent) {
    const uint64_t packs = pack4_count(extent), cells = pack4_count(half_of(half_of(extent)));
    return {buffer(packs * 3), buffer(packs * EdgePrior::kFluxStride),
            buffer(cells * EdgePrior::kValueStride)};
  }
  /// Compares what the prior of a frame wrote, its padding included.
  void expect_prior(const EdgePrior::Target& target, const reference::Guide& guide,
                    const reference::EdgePrior& expected, const std::string& what) {
    const auto same = [](double got, double want) {
      return std::abs(got - want) <= 2e-3 * (std::abs(want) + 0.01);
    };
    const Pixels system = download(target.system), flux = download(target.flux),
                 value = download(target.value);
    const reference::GuideLevel &fine = guide.level[0], &coarse = guide.level[2];
    const Extent extent{uint32_t(fine.width), uint32_t(fine.height)},
        cells{uint32_t(coarse.width), uint32_t(coarse.height)};
    for (uint32_t y = 0; y < extent.height; ++y)
      for (uint32_t x = 0; x < 4 * pack4_count(extent.width); ++x) {
        const size_t i = size_t{y} * extent.width + x;
        const bool inside = x < extent.width;
        const double weights[] = {inside ? expected.a_right[i] + expected.b_right[i] : 0,
                                  inside ? expected.a_down[i] + expected.b_down[i] : 0};
        const double fluxes[] = {
            x + 1 < extent.width ? expected.a_right[i] * (fine.m[i] - fine.m[i + 1]) : 0,
            inside && y + 1 < extent.height
                ? expected.a_down[i] * (fine.m[i] - fine.m[i + extent.width])
                : 0};
        for (size_t k = 0; k < 2; ++k) {
          const double weight = system[packed(extent, x, y, 3, k)],
                       step = flux[packed(extent, x, y, EdgePrior::kFluxStride, k)];
          ASSERT_PRED2(same, weight, weights[k]) << what << " at " << x << "," << y << " " << k;
          ASSERT_TRUE(weights[k] != 0 || weight == 0) << what << ": an edge that is missing";
          ASSERT_PRED2(same, step, fluxes[k]) << what << " at " << x << "," << y << " " << k;
        }
      }
    for (uint32_t y = 0; y < cells.height; ++y)
      for (uint32_t x = 0; x < 4 * pack4_count(cells.width); ++x) {
        const size_t i = size_t{y} * cells.width + x;
        const bool inside = x < cells.width;
        const double want[] = {inside ? expected.v[i] : 0, inside ? expected.V[i] : 0,
                               inside ? expected.g[i] : 0};
        for (size_t k = 0; k < 3; ++k) {
          const double got = value[packed(cells, x, y, EdgePrior::kValueStride, k)];
          const double small = k == 1 ? 0.1 : 0.01;  // V is a logarithm
          ASSERT_NEAR(got, want[k], 2e-3 * (std::abs(want[k]) + small))
              << what << " cell " << x << "," << y << " " << k;
        }
      }
  }
  PlanePtr input(Extent extent, const Pixels& pixels) { return shared_plane(extent, pixels); }
  static reference::IntrinsicResult expected_of(Extent extent, const Pixels& pixels,
                                                const reference::IntrinsicParams& params = {},
                                                reference::IntrinsicState* state = nullptr) {
    return reference::decompose(rgb_of(pixels).data(), int(extent.width), int(extent.height),
                                params, state);
  }
  template <typename Method>
  static const auto& last_stats(const Method& method) {
    return method.stats(method.recorded() - 1);
  }

  /// One frame through `method`; its intrinsic plane.
  Pixels decompose(IntrinsicDecomposition& method, const PlanePtr& frame,
                   const IntrinsicDecomposition::Params& params = {}, bool reset = true) {
    Pixels pixels = decompose_scaled(method, frame, params, reset);
    // Back to the solver's own scale, which is the reference's.
    const float scale = std::exp(method.findings().scale);
    for (size_t i = 0; i < pixels.size(); ++i) pixels[i] *= i % 4 == 3 ? scale : 1 / scale;
    return pixels;
  }
  Pixels decompose_scaled(IntrinsicDecomposition& method, const PlanePtr& frame,
                          const IntrinsicDecomposition::Params& params = {}, bool reset = true) {
    Layers layers;
    run([&](gpu::Commands& commands) { layers = method.record(commands, frame, params, {reset}); });
    return download(layers[Role::intrinsic]);
  }
  Pixels decompose(Extent extent, const Pixels& pixels,
                   const IntrinsicDecomposition::Params& params = {}) {
    IntrinsicDecomposition method(device, extent);
    return decompose(method, input(extent, pixels), params);
  }
};

}  // namespace inverse::testing
