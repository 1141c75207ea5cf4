// SPDX-License-Identifier: LGPL-2.1-or-later
// An environment's light shared out among the lights of a stage.
#include "kernels/lightstage/lights/light_cells.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace inverse::testing {
namespace {

constexpr double kPi = std::numbers::pi;

Environment noise(uint32_t rows, unsigned seed) {
  std::mt19937 random(seed);
  std::exponential_distribution<float> value(1);
  std::vector<float> rgb(size_t{6} * rows * rows);
  for (float& v : rgb) v = value(random);
  return {{2 * rows, rows}, std::move(rgb)};
}

Rgb total(const std::vector<Rgb>& weights) {
  Rgb sum{};
  for (const Rgb& w : weights)
    for (size_t c = 0; c < 3; ++c) sum[c] += w[c];
  return sum;
}

}  // namespace

TEST(LightCells, WhiteLightIsTheStageWithAllLightsOn) {
  for (const uint32_t count : {1u, 3u, 96u, 331u, 362u}) {
    const LightCells cells(geodesic_directions(count));
    const auto weights = cells.weights(LightCells::map(Environment::uniform({1, 2, 0})));
    EXPECT_NEAR(total(weights)[0], count, 1e-3 * count);
    EXPECT_NEAR(total(weights)[1], 2 * count, 2e-3 * count);
    EXPECT_EQ(total(weights)[2], 0);
  }
}

TEST(LightCells, CellsCoverTheSphereButTheFloor) {
  EXPECT_NEAR(LightCells(geodesic_directions(362)).covered(), 4 * kPi, 1e-3);
  EXPECT_NEAR(LightCells(geodesic_directions(1)).covered(), 4 * kPi, 1e-3);
  const double floor = 4 * kPi - LightCells(geodesic_directions(331)).covered();
  EXPECT_GT(floor, .2);
  EXPECT_LT(floor, 1.2);
}

TEST(LightCells, LightsInOnePlaceAreLightsToo) {
  const LightCells cells({{0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
  EXPECT_GT(cells.covered(), 0);
  const auto weights = cells.weights(LightCells::map(Environment::uniform({1, 1, 1})));
  EXPECT_NEAR(total(weights)[0], 3, 1e-3);
}

TEST(LightCells, EachDirectionGoesToTheNearestLight) {
  const auto lights = geodesic_directions(331);
  const LightCells cells(lights);
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    Environment map = Environment::uniform({0, 0, 0});
    const uint32_t rows = 256, row = random() % rows, column = random() % (2 * rows);
    std::vector<float> rgb(size_t{6} * rows * rows);
    rgb[3 * (row * 2 * rows + column)] = 1000;
    map = {{2 * rows, rows}, rgb};
    const auto w = map.direction(column + .5, row + .5);
    size_t nearest = 0;
    double best = -1;
    for (size_t k = 0; k < lights.size(); ++k) {
      const double near = w[0] * lights[k][0] + w[1] * lights[k][1] + w[2] * lights[k][2];
      if (near > best) {
        best = near;
        nearest = k;
      }
    }
    const auto weights = cells.weights(LightCells::map(map));
    const double angle = std::acos(best), reach = 1.5 * light_spacing(lights);
    for (size_t k = 0; k < lights.size(); ++k)
      EXPECT_EQ(weights[k][0] > 0, k == nearest && angle <= reach) << i << " " << k;
    if (angle > reach) continue;
    EXPECT_NEAR(weights[nearest][0], 1000 * map.solid_angle(row) * 331 / cells.covered(),
                1e-4 * weights[nearest][0]);
  }
}

TEST(LightCells, MapsOfAnySizeKeepTheirLight) {
  for (const uint32_t rows : {2u, 5u, 100u, 256u, 300u, 700u}) {
    const Environment map = noise(rows, rows);
    double sum = 0;
    for (uint32_t row = 0; row < rows; ++row)
      for (uint32_t column = 0; column < 2 * rows; ++column)
        sum += map.solid_angle(row) * map.rgb()[3 * (row * 2 * rows + column)];
    double flux = 0;
    const auto patches = LightCells::map(map).flux;
    for (size_t i = 0; i < patches.size(); i += 3) flux += patches[i];
    EXPECT_NEAR(flux, sum, 1e-5 * sum) << rows;
  }
}

TEST(LightCells, RotationsHaveTheirDirection) {
  // One light in front, one at the right, one behind, one at the left, above and below.
  const LightCells cells({{0, 0, 1}, {1, 0, 0}, {0, 0, -1}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}});
  std::vector<float> rgb(size_t{6} * 64 * 64);
  for (uint32_t row = 30; row < 34; ++row)
    for (uint32_t column = 62; column < 66; ++column) rgb[3 * (row * 128 + column)] = 100;
  const auto map = LightCells::map({{128, 64}, rgb});
  for (const auto& [degrees, where] :
       {std::pair{0, 0}, {90, 1}, {180, 2}, {-90, 3}, {270, 3}, {360, 0}, {-360, 0}}) {
    const auto weights = cells.weights(map, degrees * kPi / 180);
    for (int k = 0; k < 6; ++k) EXPECT_EQ(weights[static_cast<size_t>(k)][0] > 0, k == where);
  }
  // A turn by any angle loses nothing.
  const LightCells stage(geodesic_directions(362));
  const auto noisy = LightCells::map(noise(64, 3));
  const float still = total(stage.weights(noisy))[1];
  for (const double turn : {.001, .1, 1.0, -2.5, 100.0})
    EXPECT_NEAR(total(stage.weights(noisy, turn))[1], still, 1e-4 * still);
  EXPECT_EQ(stage.weights(noisy, NAN), stage.weights(noisy));
}

TEST(LightCells, ReportsTheShareOfTheLightItShows) {
  const LightCells cells(geodesic_directions(331));
  std::vector<float> rgb(size_t{6} * 32 * 32);
  for (size_t i = 0; i < 6 * 32; ++i) rgb[i] = rgb[rgb.size() - 1 - i] = 1;  // sky above, floor
  const auto map = LightCells::map({{64, 32}, rgb});
  EXPECT_NEAR(LightCells::shown(map, cells.weights(map), cells.covered()), .5, 1e-3);
  const auto dark = LightCells::map(Environment::uniform({0, 0, 0}));
  EXPECT_EQ(LightCells::shown(dark, cells.weights(dark), cells.covered()), 1);
}

}  // namespace inverse::testing
