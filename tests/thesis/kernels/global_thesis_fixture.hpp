// SPDX-License-Identifier: LGPL-2.1-or-later
// What the tests of the thesis' global decomposition share: a scene, and the comparison with the
// double-precision reference.
#pragma once
#include <algorithm>

#include "extreme_frames.hpp"
#include "kernels/thesis/chapter5/global_thesis.hpp"
#include "tests/differences.hpp"
#include "tests/kernels/gpu_fixture.hpp"
#include "tests/thesis/reference/global_thesis_params.hpp"

namespace inverse::testing {

using inverse::to_reference;  // which a member hides

using Rgb = GlobalThesis::Rgb;

/// A red and a blue wall and a light floor between, lit from above; each wall's light falls on the
/// floor. Noise of `amplitude`; `shift` moves the walls.
inline Pixels room(Extent extent, unsigned seed, uint32_t shift = 0, float amplitude = 0.01f) {
  const float colors[][3] = {{1.0f, 0.25f, 0.2f}, {0.9f, 0.9f, 0.88f}, {0.25f, 0.5f, 1.0f}};
  const Pixels noise = random_pixels(extent, seed, -amplitude, amplitude);
  Pixels pixels(extent.pixels() * 4, 1.0f);
  for (uint32_t y = 0; y < extent.height; ++y) {
    for (uint32_t x = 0; x < extent.width; ++x) {
      const size_t n = 4 * (static_cast<size_t>(y) * extent.width + x);
      const float u =
          static_cast<float>((x + shift) % extent.width) / static_cast<float>(extent.width);
      const float v = static_cast<float>(y) / static_cast<float>(extent.height);
      const size_t wall = u < 0.3f ? 0 : (u < 0.7f ? 1 : 2);
      const float direct = (3 * x + y) % 131 < 40 ? 0.2f : 0.3f + 0.4f * v;
      for (size_t c = 0; c < 3; ++c) {
        const float light = direct + 0.3f * std::exp(-5 * u) * colors[0][c] +
                            0.3f * std::exp(-5 * (1 - u)) * colors[2][c];
        pixels[n + c] = std::max(colors[wall][c] * light + noise[n + c], 0.0f);
      }
    }
  }
  return pixels;
}

inline std::vector<Rgb> random_colors(size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(0.05f, 1.0f);
  std::vector<Rgb> colors(count);
  for (Rgb& color : colors) color = {value(random), value(random), value(random)};
  return colors;
}

inline reference::Vec3 to_reference(const Rgb& color) {
  return {static_cast<double>(color[0]), static_cast<double>(color[1]),
          static_cast<double>(color[2])};
}

inline std::vector<reference::Vec3> to_reference(const std::vector<Rgb>& colors) {
  std::vector<reference::Vec3> result;
  result.reserve(colors.size());
  for (const Rgb& color : colors) result.push_back(to_reference(color));
  return result;
}

/// The device's field, plane behind plane, in the reference's order.
inline reference::GlobalField to_field(Extent extent, size_t layers, const Pixels& planes) {
  reference::GlobalField field(static_cast<int>(extent.width), static_cast<int>(extent.height),
                               layers);
  for (size_t n = 0; n < extent.pixels(); ++n) {
    for (size_t i = 0; i < field.unknowns; ++i) {
      const size_t plane = i / 4;
      field.at(n)[i] = static_cast<double>(planes[4 * (plane * extent.pixels() + n) + i % 4]);
    }
  }
  return field;
}

class GlobalThesisTest : public GpuTest {
 protected:
  /// Which cluster the device gave each pixel, as the reference takes it.
  reference::Plane targets_of(const GlobalThesis& method, Extent extent) {
    reference::Plane targets = testing::to_reference(extent, download(method.targets()));
    const Pixels features = download(method.features());
    for (size_t n = 0; n < targets.size(); ++n) targets.data[n][3] = features[4 * n + 3] >= 0;
    return targets;
  }

  /// Decomposes a frame to `output_` and collects it.
  GlobalThesis::Stats decompose(GlobalThesis& method, const Plane& frame,
                                const GlobalThesis::Hints& hints = {}) {
    uint64_t number = 0;
    run([&](gpu::Commands& commands) { number = method.record(commands, frame, output_, hints); });
    method.collect(number);
    return method.stats(number);
  }

  /// Feeds the same frames to both and compares every frame's solution and energy.
  void compare(Extent extent, GlobalThesisParams params, const std::vector<Pixels>& frames,
               const std::vector<Rgb>& colors, double tolerance = 1e-4) {
    params.energy = true;
    params.refine_rounds = 0;
    GlobalThesis method(device, extent);
    method.set_params(params);
    method.set_base_colors(colors);
    reference::GlobalThesis expected(testing::to_reference(params));
    const std::vector<reference::Vec3> layers = to_reference(method.colors().layer_colors());
    for (size_t t = 0; t < frames.size(); ++t) {
      const auto stats = decompose(method, plane(extent, frames[t]));
      ASSERT_EQ(stats.layers, static_cast<int>(colors.size()));
      const Pixels planes = download(method.solution());
      ASSERT_TRUE(all_finite(planes));
      const reference::GlobalField got = to_field(extent, colors.size(), planes);

      const Pixels features = download(method.features());
      reference::Plane chromaticities(static_cast<int>(extent.width),
                                      static_cast<int>(extent.height));
      for (size_t n = 0; n < extent.pixels(); ++n)
        chromaticities.data[n][3] = static_cast<double>(features[4 * n]);
      expected.set_chromaticities(chromaticities);
      const reference::Plane image = testing::to_reference(extent, frames[t]);
      const reference::GlobalField x =
          expected.decompose(image, targets_of(method, extent), layers);
      worst_ = max_difference(x.data, got.data);
      solution_ = got.data;
      const double reference_energy = expected.energy(x).total();
      const double energy = expected.energy(got).total();
      const std::string where =
          name_of(extent) + ", K " + std::to_string(colors.size()) + ", frame " + std::to_string(t);
      EXPECT_LT(worst_, tolerance) << where;
      EXPECT_NEAR(energy, reference_energy,
                  5e-5 * reference_energy + 2e-6 * static_cast<double>(extent.pixels()))
          << where;
      ASSERT_EQ(stats.energy.size(), 1u);
      EXPECT_NEAR(stats.energy[0].total(), energy, 1e-4 * energy + 1e-3) << where;
      printf("  %s: max |dx| %.2e, energy %.6g against %.6g\n", where.c_str(), worst_, energy,
             reference_energy);
    }
  }
  Layers output_;                 ///< of the last frame
  double worst_ = 0;              ///< of the last frame
  std::vector<double> solution_;  ///< the device's, of the last frame
};

inline const std::vector<Rgb> kRoom = {
    {1.0f, 0.25f, 0.2f}, {0.25f, 0.5f, 1.0f}, {0.9f, 0.9f, 0.88f}};

}  // namespace inverse::testing
