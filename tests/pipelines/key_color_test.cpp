// SPDX-License-Identifier: LGPL-2.1-or-later
// The color that ./dev run repaints, on images with an obvious one and on some without.
#include "../../tools/runner/key_color.hpp"

#include <gtest/gtest.h>

#include <random>

namespace inverse::run {
namespace {

constexpr int kWidth = 160, kHeight = 90;
using Rgb = std::array<float, 3>;

/// A video of gray noise, into which the tests paint.
struct Video {
  explicit Video(size_t count = 8) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> light(0.2f, 0.6f), tint(0.97f, 1.03f);
    for (size_t i = 0; i < count; ++i) {
      LinearPicture picture{kWidth, kHeight, {}};
      for (int p = 0; p < kWidth * kHeight; ++p) {
        const float gray = light(random);
        for (int c = 0; c < 3; ++c) picture.rgb.push_back(gray * tint(random));
      }
      pictures.push_back(std::move(picture));
    }
  }
  void paint(size_t picture, int x, int y, Rgb color) {
    for (size_t c = 0; c < 3; ++c)
      pictures[picture].rgb[3 * static_cast<size_t>(y * kWidth + x) + c] = color[c];
  }
  /// A square whose light falls off from left to right.
  void square(size_t picture, int left, int top, int side, Rgb color) {
    for (int y = top; y < top + side; ++y)
      for (int x = left; x < left + side; ++x) {
        const float light = 1 - 0.8f * static_cast<float>(x - left) / static_cast<float>(side);
        paint(picture, x, y, {color[0] * light, color[1] * light, color[2] * light});
      }
  }
  std::vector<LinearPicture> pictures;
};

constexpr Rgb kRed{0.7f, 0.04f, 0.06f}, kBeige{0.5f, 0.4f, 0.25f};

TEST(KeyColor, FindsAThingThatMoves) {
  Video video;
  for (size_t i = 0; i < 8; ++i) video.square(i, 10 + 5 * static_cast<int>(i), 20, 30, kRed);
  const auto key = find_key_color(video.pictures);
  ASSERT_TRUE(key);
  for (size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(key->chromaticity[c], kRed[c] * 3 / (kRed[0] + kRed[1] + kRed[2]), 0.05) << c;
  EXPECT_NEAR(key->share, 900.0 / (kWidth * kHeight), 0.001);
  EXPECT_GT(key->tolerance, 0.4);
}

TEST(KeyColor, PrefersTheSaturatedThing) {
  Video video;
  for (size_t i = 0; i < 8; ++i) {
    video.square(i, 60, 0, 80, kBeige);
    video.square(i, 10, 20, 30, kRed);
  }
  const auto key = find_key_color(video.pictures);
  ASSERT_TRUE(key);
  EXPECT_GT(key->chromaticity[0], 2.4);
}

TEST(KeyColor, FindsNothingInGray) { EXPECT_FALSE(find_key_color(Video().pictures)); }

TEST(KeyColor, FindsNothingInScatteredPixels) {
  Video video;
  std::mt19937 random(2);
  for (size_t i = 0; i < 8; ++i)
    for (int p = 0; p < 900; ++p)
      video.paint(i, static_cast<int>(random() % kWidth), static_cast<int>(random() % kHeight),
                  kRed);
  EXPECT_FALSE(find_key_color(video.pictures));
}

TEST(KeyColor, FindsNothingThatDoesNotStay) {
  Video video;
  for (size_t i = 0; i < 3; ++i) video.square(i, 10, 20, 60, kRed);
  EXPECT_FALSE(find_key_color(video.pictures));
}

TEST(KeyColor, FindsNothingWhereAllIsOfOneColor) {
  Video video;
  for (LinearPicture& picture : video.pictures)
    for (size_t i = 0; i < picture.rgb.size(); ++i) picture.rgb[i] *= kRed[i % 3];
  EXPECT_FALSE(find_key_color(video.pictures));
}

// Any key cuts right through such a picture.
TEST(KeyColor, FindsNothingWhereColorsBlend) {
  Video video;
  for (size_t i = 0; i < 8; ++i)
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        video.paint(i, x, y,
                    {0.05f + 0.5f * static_cast<float>(x) / kWidth, 0.3f,
                     0.05f + 0.5f * static_cast<float>(y) / kHeight});
  EXPECT_FALSE(find_key_color(video.pictures));
}

}  // namespace
}  // namespace inverse::run
