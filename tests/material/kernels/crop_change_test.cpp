// SPDX-License-Identifier: LGPL-2.1-or-later
// Whether the picture of an object is still the one that its layers were found in.
#include "kernels/material/object/crop_change.hpp"

#include <gtest/gtest.h>

#include <random>

namespace inverse {
namespace {

constexpr uint32_t kSide = 20;  // not of whole blocks

std::vector<float> gray(float value) {
  return std::vector<float>(size_t{4} * kSide * kSide, value);
}

TEST(CropChange, NothingIsComparedBeforeTheFirstPicture) {
  CropChange change;
  EXPECT_EQ(change.since(gray(1), {}, kSide).largest, 0);
  change.keep(gray(.5F), {}, kSide);
  EXPECT_FLOAT_EQ(change.since(gray(.75F), {}, kSide).largest, .25F);
  EXPECT_EQ(change.since(gray(.5F), {}, kSide).largest, 0);
  change.reset();
  EXPECT_EQ(change.since(gray(1), {}, kSide).largest, 0);
}

TEST(CropChange, OneBlockOfOneChannelIsEnough) {
  CropChange change;
  change.keep(gray(.5F), {}, kSide);
  auto other = gray(.5F);
  for (uint32_t y = 16; y < 20; ++y)
    for (uint32_t x = 16; x < 20; ++x) other[4 * (y * kSide + x) + 2] = .4F;
  EXPECT_NEAR(change.since(other, {}, kSide).largest, .1, 1e-5);
  EXPECT_NEAR(change.since(other, {}, kSide).mean, .1 / 9, 1e-5) << "one of nine";
  other = gray(.5F);
  for (size_t i = 3; i < other.size(); i += 4) other[i] = 9;  // not a color
  EXPECT_EQ(change.since(other, {}, kSide).largest, 0);
}

TEST(CropChange, MasksDetectMotion) {
  CropChange change;
  std::vector<uint8_t> mask(kSide * kSide, 0);
  std::fill(mask.begin(), mask.begin() + 100, 1);
  change.keep(gray(.5F), mask, kSide);
  EXPECT_EQ(change.since(gray(.9F), mask, kSide).moved, 0);
  mask[0] = 0;
  mask[100] = 1;
  EXPECT_FLOAT_EQ(change.since(gray(.5F), mask, kSide).moved, .02F);
  std::fill(mask.begin(), mask.end(), 0);
  EXPECT_FLOAT_EQ(change.since(gray(.5F), mask, kSide).moved, 100);
}

TEST(CropChange, OnlyTheObjectCounts) {
  CropChange change;
  change.keep(gray(.5F), {}, kSide);
  auto other = gray(.5F);
  std::vector<uint8_t> mask(size_t{kSide} * kSide, 1);
  for (uint32_t y = 0; y < kSide; ++y)
    for (uint32_t x = 0; x < 10; ++x) {
      mask[y * kSide + x] = 0;
      for (size_t c = 0; c < 3; ++c) other[4 * (y * kSide + x) + c] = 1;
    }
  EXPECT_EQ(change.since(other, mask, kSide).largest, 0);
  // A few of its points say little.
  std::fill(mask.begin(), mask.end(), uint8_t{0});
  mask[0] = 1;
  EXPECT_EQ(change.since(other, mask, kSide).largest, 0);
}

TEST(CropChange, NoiseAveragesOut) {
  std::mt19937 random(1);
  std::normal_distribution<float> noise(0, .03F);
  auto a = gray(.5F), b = gray(.5F);
  for (float& v : a) v += noise(random);
  for (float& v : b) v += noise(random);
  CropChange change;
  change.keep(a, {}, 16);
  EXPECT_LT(change.since(b, {}, 16).largest, .02F);
  EXPECT_GT(change.since(b, {}, 16).largest, 0);
}

}  // namespace
}  // namespace inverse
