// SPDX-License-Identifier: LGPL-2.1-or-later
// Every measure where its value is known in closed form.
#include "metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

namespace inverse::bench {
namespace {

constexpr double kNear = 1e-6;  // images are single precision

Image noise(int width, int height, int channels, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0.1F, 1.0F);
  Image image(width, height, channels);
  for (float& v : image.data) v = uniform(random);
  return image;
}

Image scaled(Image image, float factor) {
  for (float& v : image.data) v *= factor;
  return image;
}

/// 1 in the left half, `right` in the right one.
Image halves(int width, int height, float right) {
  Image image(width, height, 1, 1.0F);
  for (int y = 0; y < height; ++y)
    for (int x = width / 2; x < width; ++x) image.at(x, y) = right;
  return image;
}

/// 1 in the left half, 0 in the right one.
Image left_mask(int width, int height) { return halves(width, height, 0); }

TEST(SquaredError, IsTheMeanOverPixelsAndChannels) {
  const Image zero(4, 3, 3), half(4, 3, 3, 0.5F);
  EXPECT_DOUBLE_EQ(mse(half, zero, {}), 0.25);
  EXPECT_NEAR(psnr(half, zero, {}), 10 * std::log10(4), kNear);
  EXPECT_NEAR(psnr(half, zero, {}, 2), 10 * std::log10(16), kNear);
  EXPECT_TRUE(std::isinf(psnr(half, half, {})));
  const Image one_off = [&] {
    Image image = zero;
    image.at(3, 2, 1) = 1;
    return image;
  }();
  EXPECT_NEAR(mse(one_off, zero, {}), 1.0 / 36, kNear);
}

TEST(SquaredError, IgnoresMaskedPixels) {
  const Image truth(8, 6, 1, 1.0F), estimate = halves(8, 6, 3);
  EXPECT_DOUBLE_EQ(mse(estimate, truth, {}), 2);
  EXPECT_DOUBLE_EQ(mse(estimate, truth, left_mask(8, 6)), 0);
}

TEST(SquaredError, SizesMustAgree) {
  EXPECT_THROW(mse(Image(4, 3, 3), Image(3, 4, 3), {}), std::invalid_argument);
  EXPECT_THROW(lmse(Image(4, 3, 3), Image(4, 3, 1), {}), std::invalid_argument);
  EXPECT_THROW(ssim(Image(4, 3, 1), Image(4, 3, 1), Image(4, 3, 3)), std::invalid_argument);
}

TEST(ScaleInvariantError, IsZeroUpToAFactorPerChannel) {
  const Image truth = noise(32, 24, 3, 1);
  Image estimate = truth;
  for (std::size_t i = 0; i < estimate.data.size(); ++i)
    estimate.data[i] *= float(0.2 + double(i % 3));
  EXPECT_NEAR(scale_invariant_mse(estimate, truth, {}), 0, kNear);
  EXPECT_NEAR(lmse(estimate, truth, {}), 0, kNear);
  EXPECT_NEAR(dssim(estimate, truth, {}), 0, kNear);
}

// Truth 1 | a, estimate constant: the factor is the mean (1 + a) / 2, what is left is (1 - a)² / 4.
TEST(ScaleInvariantError, OfAConstantIsTheVariance) {
  for (const float a : {0.0F, 0.25F, 0.9F}) {
    const double left = std::pow(1 - double(a), 2) / 4;
    EXPECT_NEAR(scale_invariant_mse(Image(20, 20, 1, 0.3F), halves(20, 20, a), {}), left, kNear);
    // One window: over the mean square of the truth.
    EXPECT_NEAR(lmse(Image(20, 20, 1, 0.3F), halves(20, 20, a), {}, 20),
                left / ((1 + double(a) * a) / 2), kNear);
  }
}

TEST(ScaleInvariantError, TruthCountsAsIfItsLargestValueWereOne) {
  const Image truth = halves(20, 20, 0.5F), flat(20, 20, 1, 1.0F);
  EXPECT_NEAR(scale_invariant_mse(flat, truth, {}), scale_invariant_mse(flat, scaled(truth, 7), {}),
              kNear);
}

TEST(Lmse, OfBlackIsOne) {
  EXPECT_DOUBLE_EQ(lmse(Image(50, 40, 3), noise(50, 40, 3, 2), {}, 20), 1);
  EXPECT_DOUBLE_EQ(lmse(Image(50, 40, 3), noise(50, 40, 3, 2), {}, 10), 1);
}

// Windows of half the width see one half or a mix: of the columns of windows at 0, 10, 20 only the
// middle one straddles the step.
TEST(Lmse, FitsEveryWindowAlone) {
  const double a = 0.5;
  const Image truth = halves(40, 20, float(a)), flat(40, 20, 1, 1.0F);
  const double straddling = 400 * std::pow(1 - a, 2) / 4;
  const double all = 400 * (1 + a * a + (1 + a * a) / 2);
  EXPECT_NEAR(lmse(flat, truth, {}, 20), straddling / all, kNear);
}

TEST(Lmse, ThatIsLocalSeesNoSlowDrift) {
  Image truth(200, 20, 1, 1.0F), estimate(200, 20, 1);
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 200; ++x) estimate.at(x, y) = std::exp(0.01F * float(x));
  EXPECT_LT(lmse(estimate, truth, {}, 20), 0.004);  // variance of x / 100 in a window: 1 / 300
  EXPECT_LT(lmse(estimate, truth, {}, 10), lmse(estimate, truth, {}, 20) / 3);
  EXPECT_GT(scale_invariant_mse(estimate, truth, {}), 0.1);
}

// Of constants only luminance differs: (2ab + c1) / (a² + b² + c1); contrast and structure are 1.
TEST(Lmse, OfColorHasOneFactorForAllChannels) {
  const Image truth = noise(50, 40, 3, 2);
  EXPECT_DOUBLE_EQ(color_lmse(Image(50, 40, 3), truth, {}), 1);
  Image scaled = truth, tinted(20, 20, 3);
  for (float& v : scaled.data) v *= 3;
  EXPECT_NEAR(color_lmse(scaled, truth, {}), 0, kNear);
  // Gray for a color (1, 2, 3): what the best gray, their mean, leaves of it.
  for (std::size_t i = 0; i < tinted.data.size(); ++i) tinted.data[i] = float(1 + i % 3);
  EXPECT_NEAR(color_lmse(Image(20, 20, 3, 1), tinted, {}), 2.0 / 14, kNear);
  EXPECT_NEAR(lmse(Image(20, 20, 3, 1), tinted, {}), 0, kNear);
}

TEST(Structure, OfConstantsIsLuminance) {
  const double a = 0.8, b = 0.4, c1 = 1e-4;
  const double luminance = (2 * a * b + c1) / (a * a + b * b + c1);
  const Image first(200, 180, 1, float(a)), second(200, 180, 1, float(b));
  EXPECT_NEAR(ssim(first, second, {}), luminance, kNear);
  // Five scales fit (180 >> 4 = 11), so that luminance enters with the last exponent.
  EXPECT_NEAR(ms_ssim(first, second, {}), std::pow(luminance, 0.1333 / 1.0001), kNear);
  EXPECT_NEAR(ssim(scaled(first, 255), scaled(second, 255), {}, 255), luminance, kNear);
}

TEST(Structure, OfEqualImagesIsOne) {
  const Image image = noise(64, 48, 3, 3);
  EXPECT_NEAR(ssim(image, image, {}), 1, kNear);
  EXPECT_NEAR(ms_ssim(image, image, {}), 1, kNear);
  EXPECT_NEAR(dssim(scaled(image, 0.3F), image, {}), 0, kNear);
}

// A checkerboard against its negative about the same mean: covariance is minus the variance
// wherever the window's mean is the mean, so that SSIM is (c2 - 2v) / (c2 + 2v).
TEST(Structure, OfANegativeIsNegative) {
  Image image(48, 48, 1), negative(48, 48, 1);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 48; ++x) {
      image.at(x, y) = (x + y) % 2 ? 0.75F : 0.25F;
      negative.at(x, y) = 1 - image.at(x, y);
    }
  const double v = 0.0625, c2 = 9e-4;
  EXPECT_NEAR(ssim(image, negative, {}), (c2 - 2 * v) / (c2 + 2 * v), 1e-4);
  EXPECT_NEAR(ms_ssim(image, negative, {}), 0, 1e-12);
}

TEST(Structure, ChangesOutsideTheMaskDoNotCount) {
  const Image truth = noise(64, 48, 3, 4);
  Image estimate = truth;
  for (int y = 0; y < 48; ++y)
    for (int x = 32; x < 64; ++x) estimate.at(x, y, 1) = 0;
  EXPECT_LT(ssim(estimate, truth, {}), 0.95);
  EXPECT_NEAR(ssim(estimate, truth, left_mask(64, 48)), 1, kNear);
  EXPECT_NEAR(ms_ssim(estimate, truth, left_mask(64, 48)), 1, kNear);
}

TEST(Structure, FramesSmallerThanAWindowHaveAValue) {
  const Image tiny = noise(5, 3, 3, 5);
  EXPECT_NEAR(ssim(tiny, tiny, {}), 1, kNear);
  EXPECT_NEAR(ms_ssim(tiny, tiny, {}), 1, kNear);
  EXPECT_LT(ssim(tiny, noise(5, 3, 3, 6), {}), 0.9);
}

TEST(Whdr, ComparesByRatio) {
  Image image(2, 1, 1);
  const Judgment pair{0, 0, 1, 0};
  const auto with = [&](float first, float second) {
    image.at(0, 0) = first, image.at(1, 0) = second;
    return compare(image, pair, 0.1);
  };
  EXPECT_EQ(with(0.5F, 0.54F), Judgment::Darker::neither);
  EXPECT_EQ(with(0.5F, 0.56F), Judgment::Darker::first);
  EXPECT_EQ(with(0.56F, 0.5F), Judgment::Darker::second);
  EXPECT_EQ(with(0, 0), Judgment::Darker::neither);
}

TEST(Whdr, IsTheShareOfContradictedWeight) {
  Image image(4, 1, 3, 0.5F);
  for (int c = 0; c < 3; ++c) image.at(3, 0, c) = 1;
  using D = Judgment::Darker;
  const std::vector<Judgment> judgments{{0, 0, 1, 0, D::neither, 1},   // right
                                        {0, 0, 3, 0, D::first, 2},     // right
                                        {0, 0, 3, 0, D::second, 0.5},  // wrong
                                        {1, 0, 2, 0, D::first, 1.5}};  // wrong
  EXPECT_DOUBLE_EQ(whdr(image, judgments), 2.0 / 5);
  EXPECT_DOUBLE_EQ(whdr(image, {}), 0);
}

TEST(Whdr, OfTheTruthIsZeroAndOfAConstantTheShareOfUnequalPairs) {
  const Image truth = halves(64, 48, 0.5F);
  const auto judgments = judge(truth, {}, 4000, 7);
  ASSERT_EQ(judgments.size(), 4000U);
  EXPECT_DOUBLE_EQ(whdr(truth, judgments), 0);
  EXPECT_DOUBLE_EQ(whdr(scaled(truth, 3), judgments), 0);
  double unequal = 0;
  for (const Judgment& j : judgments)
    unequal += ((j.x0 < 32) != (j.x1 < 32)) / double(judgments.size());
  EXPECT_GT(unequal, 0.1);
  EXPECT_NEAR(whdr(Image(64, 48, 1, 1.0F), judgments), unequal, 1e-12);
  for (const Judgment& j : judge(truth, left_mask(64, 48), 500, 8)) {
    EXPECT_LT(j.x0, 32);
    EXPECT_LT(j.x1, 32);
  }
}

// Pixels that alternate between e^a and e^-a have a standard deviation of a; half of them do.
TEST(Flicker, IsTheStandardDeviationOfTheLogarithm) {
  const float a = 0.2F;
  std::vector<Image> frames;
  for (int k = 0; k < 6; ++k) {
    Image frame(8, 4, 3, 0.4F);
    for (int y = 0; y < 4; ++y)
      for (int x = 4; x < 8; ++x)
        for (int c = 0; c < 3; ++c) frame.at(x, y, c) *= std::exp(k % 2 ? a : -a);
    frames.push_back(frame);
  }
  EXPECT_NEAR(flicker(frames, false), 0.5 * double(a), kNear);
  // Less the scale ± a / 2 every pixel alternates by a / 2.
  EXPECT_NEAR(flicker(frames, true), 0.5 * double(a), kNear);
  Image right = left_mask(8, 4);
  for (float& v : right.data) v = 1 - v;
  EXPECT_NEAR(flicker(frames, false, right), double(a), kNear);
  EXPECT_NEAR(flicker(frames, true, right), 0, kNear);
  // Differences of ± a about the scale, every frame: the root mean square over the square root
  // of 2.
  EXPECT_NEAR(jitter(frames), double(a) / std::sqrt(2), kNear);
  EXPECT_NEAR(jitter(frames, right), 0, kNear);
}

TEST(Flicker, OfOneFrameIsZero) {
  EXPECT_EQ(flicker({noise(4, 4, 3, 9)}, true), 0);
  EXPECT_EQ(jitter({noise(4, 4, 3, 9)}), 0);
}

// A picture that pans by half pixels, and grows brighter by a factor every frame.
TEST(Flicker, FollowsMotion) {
  constexpr int kFrames = 5;
  std::vector<Image> frames;
  for (int k = 0; k < kFrames; ++k) {
    Image frame(40, 10, 1);
    for (int y = 0; y < 10; ++y)
      for (int x = 0; x < 40; ++x)  // linear in x, so that bilinear sampling is exact
        frame.at(x, y) = float((1 + x - 0.5 * k) * std::pow(1.1, k));
    frames.push_back(frame);
  }
  std::vector<Track> tracks;
  for (int n = 0; n < 20; ++n) {
    Track track;
    for (int k = 0; k < kFrames; ++k) track.push_back({5.0 + n + 0.5 * k, 2.5});
    tracks.push_back(track);
  }
  EXPECT_NEAR(flicker_along(frames, tracks, true), 0, kNear);
  // k ln 1.1 for k = 0 … 4 has the standard deviation √2 ln 1.1.
  EXPECT_NEAR(flicker_along(frames, tracks, false), std::sqrt(2) * std::log(1.1), kNear);
  EXPECT_GT(flicker(frames, true), 0.01);
  EXPECT_NEAR(common_drift(frames, tracks, 3), 3 * std::log(1.1), kNear);
  EXPECT_EQ(common_drift(frames, tracks, 5), 0);
  EXPECT_EQ(common_drift(frames, {tracks.front()}, 3), 0);
  const double nowhere = std::nan("");
  tracks.push_back({{1, 1}, {nowhere, 0}, {0, nowhere}, {nowhere, nowhere}, {nowhere, nowhere}});
  EXPECT_NEAR(flicker_along(frames, tracks, true), 0, kNear);
}

// A patch that grows brighter by .02 in red a frame, seen through holes; a texture does not count.
TEST(Flicker, OfAPatchIsThatOfItsMean) {
  constexpr int kFrames = 4;
  std::vector<Image> frames;
  std::vector<Track> patch(20);
  for (int k = 0; k < kFrames; ++k) {
    Image frame(20, 1, 3);
    for (int x = 0; x < 20; ++x) {
      frame.at(x, 0, 0) = 0.1F + 0.02F * float(k) + (x % 2 ? 0.05F : 0);
      frame.at(x, 0, 1) = (x + k) % 2 ? 0.3F : 0.2F;  // flickers by point, not as a patch
      patch[size_t(x)].push_back({x == k ? std::nan("") : double(x), 0});
    }
    frames.push_back(frame);
  }
  const PatchVariation found = patch_variation(frames, patch);
  EXPECT_NEAR(found.step, 0.02, 2e-3);
  EXPECT_NEAR(found.spread, 0.02, 3e-3);  // (.03 + .01 + .01 + .03) / 4
  patch.resize(14);
  EXPECT_EQ(patch_variation(frames, patch).spread, 0);
  EXPECT_EQ(patch_variation({}, {}).step, 0);
}

TEST(Flicker, StaticPixelsAreThoseWhoseTruthStays) {
  Image first(3, 1, 3, 0.5F), second = first;
  second.at(1, 0, 2) = 0.6F;
  second.at(2, 0, 0) = 0.502F;
  const Image mask = static_pixels({first, second});
  EXPECT_EQ(mask.data, (std::vector<float>{1, 0, 1}));
}

TEST(Score, OfTheTruthIsPerfectAtAnyScale) {
  const Image reflectance = noise(48, 40, 3, 10), shading = noise(48, 40, 1, 11);
  const Scores s = score(scaled(reflectance, 2), scaled(shading, 0.5F), reflectance, shading, {});
  EXPECT_NEAR(s.lmse20 + s.lmse10 + s.mse + s.dssim + s.whdr, 0, kNear);
  EXPECT_NEAR(s.ms_ssim, 1, kNear);
  EXPECT_GT(s.psnr, 100);
}

TEST(Score, LogDistanceIgnoresTheScale) {
  const Image r = noise(32, 20, 3, 12);
  EXPECT_NEAR(log_distance(scaled(r, 5), r, {}), 0, kNear);
  Image other = r;
  for (int y = 0; y < 20; ++y)
    for (int x = 16; x < 32; ++x)
      for (int c = 0; c < 3; ++c) other.at(x, y, c) *= std::exp(0.3F);
  EXPECT_NEAR(log_distance(other, r, {}), 0.15, kNear);
  EXPECT_NEAR(log_distance(other, r, left_mask(32, 20)), 0, kNear);
}

}  // namespace
}  // namespace inverse::bench
