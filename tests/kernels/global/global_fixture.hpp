// SPDX-License-Identifier: LGPL-2.1-or-later
// A room for globalintrinsic, and what the device makes of its frames.
#pragma once
#include <cmath>

#include "kernels/global/global_intrinsic.hpp"
#include "tests/kernels/intrinsic/intrinsic_fixture.hpp"
#include "tests/reference/global/global_layers.hpp"
#include "tests/reference/image/light_color.hpp"

namespace inverse::testing {

/// A red wall on the left, a green one on the right, gray, white and yellow patches between, direct
/// light from above that a shadow cuts, and light that bounced off the walls.
struct Room {
  Pixels frame;
  std::vector<double> reflectance, direct, indirect;  // 3, 1, 3 channels
};

inline Room room(Extent extent, unsigned seed, float bounced = 0.35F) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  const std::array<std::array<float, 3>, 5> paints{{{0.75F, 0.12F, 0.1F},
                                                    {0.15F, 0.6F, 0.15F},
                                                    {0.7F, 0.7F, 0.7F},
                                                    {0.3F, 0.3F, 0.3F},
                                                    {0.7F, 0.6F, 0.1F}}};
  Room made;
  made.frame.assign(extent.pixels() * 4, 1);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      const float u = (static_cast<float>(x) + 0.5F) / static_cast<float>(extent.width),
                  v = (static_cast<float>(y) + 0.5F) / static_cast<float>(extent.height);
      const bool left = u<0.25F, right = u> 0.75F;
      const size_t patch = static_cast<size_t>(u * 12) + 3 * static_cast<size_t>(v * 5);
      const auto& paint = paints[left ? 0 : right ? 1 : 2 + patch % 3];
      const float shadow = v > 0.5F && u > 0.4F && u < 0.65F ? 0.05F : 1.0F;
      const float direct = shadow * (0.6F - 0.3F * v);
      // A wall does not light itself.
      const float from_red = left ? 0.05F : bounced * 0.6F * std::exp(-3 * (u - 0.25F));
      const float from_green = right ? 0.05F : bounced * 0.6F * std::exp(-3 * (0.75F - u));
      for (size_t c = 0; c < 3; ++c) {
        const float indirect = 0.25F * bounced + (left ? 0 : from_red * paints[0][c]) +
                               (right ? 0 : from_green * paints[1][c]);
        const float light = direct + indirect;
        made.reflectance.push_back(paint[c]);
        made.indirect.push_back(indirect);
        made.frame[4 * (static_cast<size_t>(y) * extent.width + x) + c] =
            paint[c] * light * (0.99F + 0.02F * unit(random));
      }
      made.direct.push_back(direct);
    }
  return made;
}

class GlobalTest : public IntrinsicTest {
 protected:
  struct Result {
    Layers layers;
    Pixels intrinsic, light;
    GlobalIntrinsic::Findings found;
  };
  Result decompose(GlobalIntrinsic& method, const Pixels& frame, Extent extent,
                   const GlobalIntrinsic::Params& params, GlobalIntrinsic::FrameInfo info) {
    Result result;
    run([&](gpu::Commands& commands) {
      result.layers = method.record(commands, input(extent, frame), params, info);
    });
    result.intrinsic = download(result.layers[Role::intrinsic]);
    result.light = download(result.layers[Role::light]);
    result.found = method.findings(method.recorded() - 1);
    return result;
  }
  static GlobalIntrinsic::Params gray_light() {
    GlobalIntrinsic::Params params;
    params.light.slope = 0;
    return params;
  }
  static GlobalIntrinsic::Params to_the_letter() {
    GlobalIntrinsic::Params params = gray_light();
    params.adaptive = false;
    return params;
  }
  /// The specification's result for a frame.
  static reference::GlobalResult expected_of(const Pixels& frame, Extent extent,
                                             const reference::GlobalParams& params = {},
                                             reference::GlobalState* state = nullptr) {
    return reference::decompose_global(rgb_of(frame).data(), int(extent.width), int(extent.height),
                                       params, state);
  }
  /// R S L in the light's color is the frame, and direct light is part of all.
  void expect_product(const Result& got, const Pixels& frame) {
    const PlanePtr& slope = got.layers[Role::slope];
    const Pixels carried = slope ? download(slope) : Pixels(4, 0.0F);
    const reference::LightColor color{double(carried[0]), 0, double(carried[1])};
    for (size_t i = 0; i < frame.size(); ++i) {
      if (i % 4 == 3) continue;
      const double shading = std::log(std::max(double(got.intrinsic[i | 3]), 1e-30));
      const double tint = reference::light_color(color, shading - color.white)[i % 4];
      ASSERT_NEAR(double(got.intrinsic[i] * got.intrinsic[i | 3] * got.light[i]) * tint, frame[i],
                  1e-5)
          << i;
      ASSERT_GE(got.light[i], got.light[i | 3] - 1e-6F) << i;
    }
  }
  /// Light's color and direct share, base colors and reflectance against the specification.
  static void expect_agreement(const Result& got, const reference::GlobalResult& expected,
                               const std::string& what) {
    EXPECT_NEAR(got.found.amount, expected.amount.value, 5e-3 * expected.amount.value) << what;
    EXPECT_NEAR(got.found.confidence, expected.amount.confidence, 5e-3) << what;
    EXPECT_EQ(got.found.colors, uint32_t(expected.colors.used())) << what;
    EXPECT_NEAR(got.found.tint, expected.tint, 2e-3 + 2e-3 * expected.tint) << what;
    for (size_t k = 0; k < expected.colors.color.size(); ++k) {
      const auto& color = expected.colors.color[k];
      const auto& base = got.found.bases[k];
      EXPECT_EQ(base[0] > 0, color.has_value()) << what << ", slot " << k;
      if (!color || !(base[0] > 0)) continue;
      const auto u = std::log(double(base[0]) / double(base[1])) / std::sqrt(2);
      EXPECT_NEAR(u, (*color)[0], 0.02) << what << ", slot " << k;
    }
    const size_t n = expected.direct.size();
    // The output's scale follows a median, which jumps where few points are in the middle.
    double scale = 0;
    const auto log_ratio = [&](size_t i, size_t c) {
      return std::log(got.intrinsic[4 * i + c] + 1e-3) -
             std::log(expected.reflectance[3 * i + c] + 1e-3);
    };
    for (size_t i = 0; i < n; ++i)
      for (size_t c = 0; c < 3; ++c) scale += log_ratio(i, c) / double(3 * n);
    EXPECT_NEAR(scale, 0, 0.02) << what;
    double tint2 = 0, direct2 = 0, paint2 = 0;
    for (size_t i = 0; i < n; ++i) {
      double geometric = 0;
      for (size_t c = 0; c < 3; ++c)
        geometric += std::log(expected.direct[i] + expected.indirect[3 * i + c]) / 3;
      for (size_t c = 0; c < 3; ++c) {
        const double tau = std::log(expected.direct[i] + expected.indirect[3 * i + c]) - geometric;
        tint2 += std::pow(std::log(got.light[4 * i + c]) - tau, 2) / double(3 * n);
        paint2 += std::pow(log_ratio(i, c) - scale, 2) / double(3 * n);
      }
      const double direct =
          double(got.light[4 * i + 3]) * got.intrinsic[4 * i + 3] * std::exp(scale);
      direct2 += std::pow(direct - expected.direct[i], 2) / double(n);
    }
    EXPECT_LT(std::sqrt(tint2), 3e-3) << what;
    EXPECT_LT(std::sqrt(paint2), 2e-3) << what;
    EXPECT_LT(std::sqrt(direct2), 2e-3) << what;
  }
};

}  // namespace inverse::testing
