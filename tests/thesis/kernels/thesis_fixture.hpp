// SPDX-License-Identifier: LGPL-2.1-or-later
// The thesis' method on the device against the double-precision reference.
#pragma once
#include <algorithm>

#include "kernels/image/pack4.hpp"
#include "kernels/thesis/chapter3/thesis_decomposition.hpp"
#include "tests/differences.hpp"
#include "tests/kernels/gpu_fixture.hpp"
#include "tests/kernels/known_reflectance.hpp"
#include "tests/thesis/reference/known_targets.hpp"
#include "tests/thesis/reference/thesis_params.hpp"

namespace inverse::testing {

/// Patches of a few colors under a shading ramp with a shadow's edge, and noise of `amplitude`;
/// `shift` moves the patches.
inline Pixels scene(Extent extent, unsigned seed, uint32_t shift = 0, float amplitude = 0.01f) {
  const float colors[][3] = {
      {0.8f, 0.3f, 0.2f}, {0.2f, 0.5f, 0.7f}, {0.6f, 0.6f, 0.55f}, {0.15f, 0.3f, 0.1f}};
  const Pixels noise = random_pixels(extent, seed, -amplitude, amplitude);
  Pixels pixels(extent.pixels() * 4, 1.0f);
  for (uint32_t y = 0; y < extent.height; ++y) {
    for (uint32_t x = 0; x < extent.width; ++x) {
      const size_t n = 4 * (static_cast<size_t>(y) * extent.width + x);
      const float ramp = 0.3f + 0.7f * static_cast<float>(y) / static_cast<float>(extent.height);
      const float shading = (3 * x + y) % 131 < 40 ? 0.3f * ramp : ramp;
      const auto& color = colors[((x + shift) / 23 * 7 + y / 17 * 3) % 4];
      for (size_t c = 0; c < 3; ++c)
        pixels[n + c] = std::max(color[c] * shading + noise[n + c], 0.0f);
    }
  }
  return pixels;
}

/// A stroke of constant shading across the picture, one of constant reflectance below it, and one
/// that covers nothing; weights fall toward the borders. At any size.
inline reference::StrokeMask strokes_on(int width, int height) {
  using reference::StrokeKind;
  reference::StrokeMask mask{
      {StrokeKind::shading, StrokeKind::reflectance, StrokeKind::shading}, {}, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double u = (x + 0.5) / width, v = (y + 0.5) / height;
      const double depth = 0.2 - std::abs(v - 0.1 - 0.2 * u),
                   low = 0.15 - std::hypot(u - 0.6, v - 0.75);
      mask.stroke.push_back(depth > 0 ? 0 : low > 0 ? 1 : -1);
      // What a float of a mask holds beside the number.
      const double weight = std::min(10 * std::max({depth, low, 0.0}), 1.0);
      mask.weight.push_back(std::floor(weight * weight * 4096) / 4096);
    }
  }
  return mask;
}

class ThesisTest : public GpuTest {
 protected:
  /// The strokes of `strokes_on` for the device.
  ThesisStrokes device_strokes(Extent extent) {
    using Kind = ThesisStrokes::Kind;
    const auto mask = strokes_on(static_cast<int>(extent.width), static_cast<int>(extent.height));
    const uint32_t pitch = 4 * pack4_count(extent.width);
    Pixels pixels(size_t{pitch} * extent.height);
    for (uint32_t y = 0; y < extent.height; ++y)
      for (uint32_t x = 0; x < extent.width; ++x) {
        const size_t n = size_t{y} * extent.width + x;
        if (mask.stroke[n] >= 0)
          pixels[size_t{y} * pitch + x] =
              static_cast<float>(mask.stroke[n] + 1 + mask.weight[n] / 2);
      }
    return {{Kind::shading, Kind::reflectance, Kind::shading}, upload(pixels)};
  }

  /// The chromaticities that samples compare are the reference's own, but for a step of their grid.
  static void check_chromaticities(const reference::IntrinsicThesis& expected,
                                   const std::vector<reference::Plane>& got) {
    for (size_t n = 0; n < got.size(); ++n) {
      const reference::Plane& own = expected.levels()[n].chromaticity;
      for (size_t k = 0; k < own.size(); ++k) {
        const double a = reference::pack_chromaticity(own.data[k]), b = got[n].data[k][3];
        const double red = std::floor(a / 4096) - std::floor(b / 4096);
        ASSERT_LE(std::abs(red), 1) << "level " << n << ", pixel " << k;
        ASSERT_LE(std::abs(a - b - 4096 * red), 1) << "level " << n << ", pixel " << k;
      }
    }
  }

  /// Decomposes a frame to `layers_`.
  ThesisDecomposition::Stats decompose(ThesisDecomposition& method, const Plane& frame,
                                       const KnownReflectance* known = nullptr) {
    uint64_t number = 0;
    run([&](gpu::Commands& commands) { number = method.record(commands, frame, layers_, known); });
    return method.stats(number);
  }

  /// Feeds the same frames to both and compares every frame's solution and energy.
  void compare(Extent extent, ThesisParams params, const std::vector<Pixels>& frames) {
    params.energy = true;
    ThesisDecomposition method(device, extent);
    method.set_params(params);
    reference::IntrinsicThesis expected(to_reference(params));
    if (strokes_) {
      method.set_strokes(device_strokes(extent));
      expected.set_strokes(
          strokes_on(static_cast<int>(extent.width), static_cast<int>(extent.height)));
    }
    double scale_before = 0;
    for (size_t t = 0; t < frames.size(); ++t) {
      std::optional<Known> known;
      if (known_weight_ > 0 && t > 0) {
        known = known_of(Lab(device), known_extent_, static_cast<unsigned>(t), known_weight_);
        expected.set_known(
            reference::known_targets(to_reference(extent, frames[t]), known->expected, scale_before,
                                     to_reference(params)),
            double{known_weight_});
      }
      const auto stats =
          decompose(method, plane(extent, frames[t]), known ? &known->given : nullptr);
      scale_before = static_cast<double>(stats.scale);
      const Pixels got = download(method.solution());
      ASSERT_TRUE(all_finite(got));

      std::vector<reference::Plane> chromaticities;
      for (int n = 0; n < stats.levels; ++n) {
        const Plane level = method.sample_frame(n);
        chromaticities.push_back(to_reference(level.extent, download(level)));
      }
      expected.set_chromaticities(chromaticities);
      expected.set_clusters(stats.clustered ? to_reference(extent, download(method.clusters()))
                                            : reference::Plane());
      const reference::Plane x = expected.decompose(to_reference(extent, frames[t]));
      if (params.w_non_local > 0 && params.samples > 0)
        check_chromaticities(expected, chromaticities);
      double scale = 0;
      std::vector<double> wanted;
      for (size_t n = 0; n < x.size(); ++n) {
        for (size_t c = 0; c < 3; ++c) {
          scale += (got[4 * n + c] - x.data[n][c]) / (3.0 * static_cast<double>(x.size()));
          wanted.push_back(x.data[n][c]);
        }
      }
      solution_.clear();
      for (size_t i = 0; i < got.size(); ++i)
        if (i % 4 != 3) solution_.push_back(static_cast<double>(got[i]) - scale);
      worst_ = max_difference(wanted, solution_);
      const double reference_energy = expected.energy(x).total();
      const double energy = expected.energy(to_reference(extent, got)).total();
      const std::string where = name_of(extent) + ", frame " + std::to_string(t);
      EXPECT_LT(worst_, tolerance_) << where;
      EXPECT_NEAR(energy, reference_energy, 1e-5 * reference_energy + 1e-6) << where;
      ASSERT_EQ(stats.energy.size(), 1u);
      EXPECT_NEAR(stats.energy[0].total(), energy, 3e-5 * energy + 1e-3) << where;
      RecordProperty("max_difference_" + std::to_string(extent.width), std::to_string(worst_));
      printf("  %s: max |dr| %.2e, energy %.6g against %.6g\n", where.c_str(), worst_, energy,
             reference_energy);
    }
  }
  bool strokes_ = false;     ///< `compare` with strokes
  double tolerance_ = 3e-5;  ///< of `compare`, log units
  float known_weight_ = 0;   ///< `compare` with reflectance that is known from frame 1 on
  Extent known_extent_;
  Layers layers_;                 ///< of the last frame
  double worst_ = 0;              ///< of the last frame, log units
  std::vector<double> solution_;  ///< the device's r of the last frame in the reference's scale
};

inline const std::vector<Extent> kSizes = {{1, 1}, {2, 3}, {1, 40}, {17, 5}, {15, 10}, {64, 48}};

}  // namespace inverse::testing
