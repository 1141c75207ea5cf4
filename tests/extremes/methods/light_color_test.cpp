// SPDX-License-Identifier: LGPL-2.1-or-later
// The color of light in frames that do not show it, or show another than a scene has: gray film,
// one color, clipped light, stage light, channels that are swapped or missing; at its limits.
#include "tests/reference/image/light_color.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>

#include "pictures.hpp"
#include "tests/update_max.hpp"

namespace inverse::extremes {
namespace {

constexpr Extent kExtent{96, 72};
constexpr Solver kSolvers[] = {Solver::multigrid, Solver::global};

/// White, red, black, blue and gray side by side; their lower halves lie in a shadow. Light has
/// this slope.
Pixels scene(float slope = 0.5F) {
  Pixels pixels = walls(kExtent,
                        {{0.9F, 0.9F, 0.9F},
                         {0.6F, 0.1F, 0.08F},
                         {0.08F, 0.08F, 0.08F},
                         {0.1F, 0.2F, 0.5F},
                         {0.4F, 0.4F, 0.4F}},
                        0.02F);
  for (size_t i = pixels.size() / 8 * 4; i < pixels.size(); i += 4) {
    const float shadow = 0.35F, red = std::exp(0.5F * slope * std::log(shadow));
    pixels[i] *= shadow * red, pixels[i + 1] *= shadow, pixels[i + 2] *= shadow / red;
  }
  return pixels;
}

Pixels changed(const std::function<void(float*, uint32_t x)>& change) {
  Pixels pixels = scene();
  for (size_t i = 0; i < pixels.size(); i += 4) change(&pixels[i], uint32_t(i / 4 % kExtent.width));
  return pixels;
}

using Change = std::function<void(float*, uint32_t x)>;
const std::map<std::string, Change> kChanges{
    {"gray film", [](float* p, uint32_t) { p[0] = p[2] = p[1]; }},
    {"sepia film", [](float* p, uint32_t) { p[0] = 1.2F * p[1], p[2] = 0.7F * p[1]; }},
    {"clipped",
     [](float* p, uint32_t) {
       std::transform(p, p + 3, p, [](float v) { return std::min(6 * v, 1.0F); });
     }},
    {"one color", [](float* p, uint32_t) { p[0] = 0.6F, p[1] = 0.3F, p[2] = 0.1F; }},
    {"red stage light", [](float* p, uint32_t) { p[1] *= 0.01F, p[2] = 0; }},
    {"red and blue stage light",
     [](float* p, uint32_t x) { p[1] *= 0.02F, p[x < 48 ? 0 : 2] *= 0.02F; }},
    {"red and blue swapped", [](float* p, uint32_t) { std::swap(p[0], p[2]); }},
    {"no green", [](float* p, uint32_t) { p[1] = 0; }},
    {"no blue", [](float* p, uint32_t) { p[2] = 0; }},
    {"black", [](float* p, uint32_t) { p[0] = p[1] = p[2] = 0; }}};

Pixels changed(const std::string& name) { return changed(kChanges.at(name)); }

class LightColorAtExtremes : public testing::Test {
 protected:
  /// The last of three equal frames.
  Output decompose(Solver solver, const Pixels& frame, std::optional<float> slope) {
    Method method(lab_, solver, kExtent);
    GlobalIntrinsic::Params params;
    params.light.slope = slope;
    params.adaptive = false;
    if (solver == Solver::global)
      method.set(params);
    else
      method.set(static_cast<const ScaledIntrinsic::Params&>(params));
    for (int k = 0; k < 2; ++k) method.decompose(frame);
    return method.decompose(frame);
  }
  static std::string text_of(std::optional<float> slope) {
    return slope ? std::to_string(*slope) : "auto";
  }

  const Lab lab_;
};

TEST_F(LightColorAtExtremes, LayersMultiplyToAnyFrame) {
  for (const Solver solver : kSolvers)
    for (const auto& [name, change] : kChanges)
      for (const std::optional<float> slope : {std::optional<float>(), {-2.0F}, {2.0F}}) {
        const Pixels frame = changed(change);
        const Output got = decompose(solver, frame, slope);
        const std::string what = name + ", slope " + text_of(slope);
        double worst = 0;
        bool finite = true;
        for (size_t i = 0; i < frame.size(); i += 4)
          for (size_t c = 0; c < 3; ++c) {
            const float shading = got.intrinsic[i + 3];
            const float light = solver == Solver::global ? got.light[i + c] : 1;
            const auto product = double(got.intrinsic[i + c] * shading * light);
            finite = finite && std::isfinite(product) && shading >= 0 && got.intrinsic[i + c] >= 0;
            update_max(worst, std::abs(product - double(frame[i + c])));
          }
        EXPECT_TRUE(finite) << what;
        EXPECT_LT(worst, 2e-4) << what;
      }
}

TEST_F(LightColorAtExtremes, FilmWithoutColorHasGrayLight) {
  for (const Solver solver : kSolvers)
    for (const char* name : {"gray film", "one color", "black"}) {
      const Output got = decompose(solver, changed(name), {});
      ASSERT_FALSE(got.slope.empty()) << name;
      EXPECT_EQ(got.slope[0], 0) << name;
    }
}

/// ln R/B of the reflectance of a pixel.
double hue(const Output& got, size_t i) {
  const reference::LightColor light{double(got.slope[0]), 0, double(got.slope[1])};
  const auto color =
      reference::light_color(light, std::log(double(got.intrinsic[i + 3])) - light.white);
  return std::log(double(got.intrinsic[i]) / color[0]) -
         std::log(double(got.intrinsic[i + 2]) / color[2]);
}

TEST_F(LightColorAtExtremes, NeutralThingsInTheBrightestLightStayNeutral) {
  for (const std::optional<float> slope : {std::optional<float>(), {-0.8F}, {0.5F}, {0.8F}}) {
    const Output got = decompose(Solver::multigrid, scene(slope.value_or(0.5F)), slope);
    double sum = 0, count = 0;
    for (uint32_t y = 2; y < 12; ++y)  // the white wall
      for (uint32_t x = 2; x < 17; ++x)
        sum += hue(got, 4 * (size_t{y} * kExtent.width + x)), ++count;
    EXPECT_NEAR(sum / count, 0, 0.06) << "slope " << text_of(slope);
  }
}

TEST_F(LightColorAtExtremes, FilmOfOneHueKeepsIt) {
  for (const char* name : {"gray film", "sepia film"}) {
    const Pixels frame = changed(name);
    const Output got = decompose(Solver::multigrid, frame, {});
    double worst = 0;
    for (size_t i = 0; i < frame.size(); i += 4)
      update_max(worst, std::abs(hue(got, i) - std::log(double(frame[i]) / double(frame[i + 2]))));
    EXPECT_LT(worst, 0.15) << name << ", slope " << got.slope[0];
  }
}

TEST_F(LightColorAtExtremes, SwappedChannelsHaveTheOppositeSlope) {
  const Output got = decompose(Solver::multigrid, scene(), 0.5F);
  const Output swapped = decompose(Solver::multigrid, changed("red and blue swapped"), -0.5F);
  double sum = 0;
  for (size_t i = 3; i < got.intrinsic.size(); i += 4) {
    const double d = std::log(double(got.intrinsic[i])) - std::log(double(swapped.intrinsic[i]));
    sum += d * d;
  }
  EXPECT_LT(std::sqrt(sum / double(kExtent.pixels())), 0.02);
}

}  // namespace
}  // namespace inverse::extremes
