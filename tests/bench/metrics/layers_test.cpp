// SPDX-License-Identifier: LGPL-2.1-or-later
// Measures of direct and indirect light where their values are known in closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "metrics.hpp"
#include "tests/update_max.hpp"

namespace inverse::bench {
namespace {

constexpr double kNear = 1e-6;  // images are single precision
constexpr int kWidth = 8, kHeight = 6;

Image even(float r, float g, float b) {
  Image image(kWidth, kHeight, 3);
  for (std::size_t i = 0; i < image.data.size(); i += 3)
    image.data[i] = r, image.data[i + 1] = g, image.data[i + 2] = b;
  return image;
}

/// One gray in the left half, another in the right one.
Image halves(float left, float right) {
  Image image(kWidth, kHeight, 3, left);
  for (int y = 0; y < kHeight; ++y)
    for (int x = kWidth / 2; x < kWidth; ++x)
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = right;
  return image;
}

Image left_mask() {
  Image mask(kWidth, kHeight, 1);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth / 2; ++x) mask.at(x, y) = 1;
  return mask;
}

TEST(Layers, BestScaleIsOneForAllChannels) {
  EXPECT_NEAR(best_scale(even(1, 2, 3), even(2, 4, 6), {}), 2, kNear);
  // (1, 0, 0) to (1, 1, 1): only red can be met; to (0, 1, 1): nothing can.
  EXPECT_NEAR(best_scale(even(1, 0, 0), even(1, 1, 1), {}), 1, kNear);
  EXPECT_NEAR(best_scale(even(1, 1, 1), even(3, 0, 0), {}), 1, kNear);
  EXPECT_DOUBLE_EQ(best_scale(even(0, 0, 0), even(1, 1, 1), {}), 0);
  EXPECT_NEAR(best_scale(halves(1, 5), halves(3, 0), left_mask()), 3, kNear);
}

TEST(Layers, RelativeErrorIsOneOfBlack) {
  const Image truth = halves(0.5F, 1);
  EXPECT_DOUBLE_EQ(relative_error(truth, truth, {}, 1), 0);
  EXPECT_NEAR(relative_error(even(0, 0, 0), truth, {}, 1), 1, kNear);
  EXPECT_NEAR(relative_error(truth, truth, {}, 1.1), 0.01, kNear);
  // A constant for (1, 3) at its best scale: mean 2, squares 1 + 1 over 1 + 9.
  const Image steps = halves(1, 3), flat = even(1, 1, 1);
  EXPECT_NEAR(relative_error(flat, steps, {}, best_scale(flat, steps, {})), 0.2, kNear);
  EXPECT_NEAR(relative_error(flat, steps, left_mask(), 1), 0, kNear);
}

TEST(Layers, TintIsTheDistanceOfLogChroma) {
  const Image gray = even(0.5F, 0.5F, 0.5F);
  EXPECT_NEAR(tint_error(gray, gray, {}), 0, kNear);
  EXPECT_NEAR(tint_error(halves(0.1F, 0.9F), gray, {}), 0, kNear);  // brightness is no tint
  // ln(r / g) / sqrt 2 and ln(r g / b²) / sqrt 6 of (e - .003, 1 - .003, 1 - .003): both ln e
  // apart.
  const auto e = float(std::exp(1.0));
  const Image red = even(e - 0.003F, 0.997F, 0.997F);
  EXPECT_NEAR(tint_error(gray, red, {}), std::sqrt(1.0 / 2 + 1.0 / 6), kNear);
  EXPECT_NEAR(tint_error(red, red, {}), 0, kNear);
  // The estimate is scaled to the truth before the floor is added.
  EXPECT_NEAR(tint_error(even(10 * (e - 0.003F), 9.97F, 9.97F), red, {}), 0, kNear);
}

TEST(Layers, TheSplitCountsAtTheJointScale) {
  const Image direct = even(0.6F, 0.6F, 0.6F), indirect = even(0.4F, 0.4F, 0.4F);
  const LayerScores same = score_layers(direct, indirect, direct, indirect, {});
  EXPECT_NEAR(same.ind, 0, kNear);
  EXPECT_NEAR(same.dir_j, 0, kNear);
  EXPECT_NEAR(same.ind_j, 0, kNear);
  EXPECT_NEAR(same.tint, 0, kNear);
  // Twice everything is one scale.
  const LayerScores twice =
      score_layers(even(1.2F, 1.2F, 1.2F), even(0.8F, 0.8F, 0.8F), direct, indirect, {});
  EXPECT_NEAR(twice.dir_j, 0, kNear);
  EXPECT_NEAR(twice.ind_j, 0, kNear);
  // Half of the indirect light taken for direct: the shape is right, the amounts are not.
  const LayerScores shifted =
      score_layers(even(0.8F, 0.8F, 0.8F), even(0.2F, 0.2F, 0.2F), direct, indirect, {});
  EXPECT_NEAR(shifted.ind, 0, kNear);
  EXPECT_NEAR(shifted.dir_j, 1.0 / 9, kNear);
  EXPECT_NEAR(shifted.ind_j, 1.0 / 4, kNear);
}

TEST(Layers, ScoreLmseIsThatOfScore) {
  const Image truth = halves(0.2F, 0.8F), estimate = even(0.5F, 0.4F, 0.3F);
  Image shading(kWidth, kHeight, 1, 0.5F), true_shading(kWidth, kHeight, 1, 0.5F);
  shading.at(1, 1) = 1;
  EXPECT_DOUBLE_EQ(score_lmse(estimate, shading, truth, true_shading, {}),
                   score(estimate, shading, truth, true_shading, {}).lmse20);
}

}  // namespace
}  // namespace inverse::bench
