// SPDX-License-Identifier: LGPL-2.1-or-later
// Light divided by direction.
#include "kernels/environment/light_beams.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace inverse::testing {
namespace {

LightBeams divided(const Environment& light) {
  return divided_light(PrefilteredLight(light).cells);
}

/// A gray map of `low` with a square of `high` around a pixel.
Environment with_lamp(uint32_t column, uint32_t row, float low, float high) {
  constexpr uint32_t kRows = 64;
  std::vector<float> rgb;
  for (uint32_t y = 0; y < kRows; ++y)
    for (uint32_t x = 0; x < 2 * kRows; ++x)
      rgb.insert(
          rgb.end(), 3,
          std::max(x, column) - std::min(x, column) < 2 && std::max(y, row) - std::min(y, row) < 2
              ? high
              : low);
  return {{2 * kRows, kRows}, rgb};
}

}  // namespace

TEST(LightBeamsTest, AllLightIsInOneOfThem) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> value(0, 1);
  for (int n = 0; n < 8; ++n) {
    std::vector<float> rgb(3 * 32 * 16);
    for (float& v : rgb) v = n == 7 ? 0 : std::pow(value(random), float(1 + 3 * n));
    const Environment light({32, 16}, rgb);
    const LightBeams got = divided(light);
    double flux = 0, sum = 0;
    std::array<double, 3> moment{}, expected{};
    for (const LightBeam& beam : got.beams) {
      EXPECT_GT(beam.flux, 0);
      double length = 0;
      for (size_t c = 0; c < 3; ++c) {
        moment[c] += double{beam.flux} * double{beam.mean[c]};
        length += double{beam.mean[c]} * double{beam.mean[c]};
      }
      EXPECT_LE(length, 1 + 1e-6);
      flux += double{beam.flux};
    }
    for (uint32_t y = 0; y < 16; ++y)
      for (uint32_t x = 0; x < 32; ++x) {
        const float* p = &rgb[3 * (y * 32 + x)];
        const double power =
            light.solid_angle(y) * (double{p[0]} + double{p[1]} + double{p[2]}) / 3;
        const auto way = light.direction(x + .5, y + .5);
        for (size_t c = 0; c < 3; ++c) expected[c] += power * way[c];
        sum += power;
      }
    EXPECT_NEAR(flux, sum, 1e-4 * sum);
    // Directions of cells are weighted by luminance, and pixels here by their middle.
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(moment[c], expected[c], 0.02 * sum) << n;
    EXPECT_LE(got.beams.size(), 16U);
    EXPECT_LE(got.lamps, LightBeams::kMaxLamps);
  }
}

TEST(LightBeamsTest, LampsAreWhereTheyAre) {
  for (const auto& [column, row] : {std::pair{20U, 12U}, {64U, 32U}, {100U, 50U}, {0U, 30U}}) {
    const Environment light = with_lamp(column, row, 0.1F, 50);
    const LightBeams got = divided(light);
    ASSERT_GE(got.lamps, 1U);
    const auto way = light.direction(column + 0.5, row + 0.5);
    double dot = 0, length = 0;
    for (size_t c = 0; c < 3; ++c) {
      dot += way[c] * double{got.beams[0].mean[c]};
      length += double{got.beams[0].mean[c]} * double{got.beams[0].mean[c]};
    }
    if (column > 0) {
      EXPECT_GT(dot / std::sqrt(length), std::cos(4 * std::numbers::pi / 180));
    }
    EXPECT_GT(length, 0.97);
    // The rest surrounds.
    EXPECT_EQ(got.beams.size(), got.lamps + 8);
  }
}

TEST(LightBeamsTest, EvenLightHasNoLampAndNoneHasNoBeam) {
  const LightBeams even = divided(Environment::uniform({2, 2, 2}));
  EXPECT_EQ(even.lamps, 0U);
  ASSERT_EQ(even.beams.size(), 8U);
  for (const LightBeam& beam : even.beams) {
    EXPECT_NEAR(beam.flux, std::numbers::pi, 0.01);
    for (const float v : beam.mean) EXPECT_NEAR(std::abs(v), 0.5, 0.01);
  }
  EXPECT_TRUE(divided(Environment::uniform({0, 0, 0})).beams.empty());
}

}  // namespace inverse::testing
