// SPDX-License-Identifier: LGPL-2.1-or-later
// What globalintrinsic skips: light of scenes without color, and of repeated pictures.
#include <cmath>

#include "global_fixture.hpp"

namespace inverse::testing {

/// The same frame without color: as black-and-white film, or toned as sepia.
Pixels colorless(Pixels frame, const std::array<float, 3>& tone = {1, 1, 1}) {
  for (size_t i = 0; i < frame.size(); i += 4)
    for (const size_t c : {2, 1, 0}) frame[i + c] = frame[i] * tone[c];
  return frame;
}

TEST_F(GlobalTest, FramesWithoutColorHaveDirectLightAlone) {
  const Extent extent{90, 70};
  for (const auto& tone : {std::array{1.0F, 1.0F, 1.0F}, std::array{1.0F, 0.85F, 0.65F}}) {
    const Pixels frame = colorless(room(extent, 2).frame, tone);
    GlobalIntrinsic method(device, extent);
    ScaledIntrinsic alone(device, extent);
    for (int k = 0; k < 16; ++k) {
      const Result got = decompose(method, frame, extent, gray_light(), {false, true});
      EXPECT_EQ(got.found.colors, 0U);
      EXPECT_EQ(got.found.amount, 0);
      EXPECT_EQ(got.found.confidence, 0);
      EXPECT_LT(got.found.chroma, 0.02F);
      for (const float light : got.light)
        ASSERT_NEAR(light, 1, 1e-6) << "frame " << k;  // a quotient, which Vulkan lets err
      const bool plain = last_stats(method).light.gray;
      EXPECT_EQ(plain, k >= 10) << "frame " << k;
      EXPECT_EQ(plain, !got.layers[indirect_role(0)]) << "frame " << k;
      EXPECT_EQ(plain, !got.layers[Role::bases]) << "frame " << k;
      Layers two;
      run([&](gpu::Commands& commands) {
        two = alone.record(commands, input(extent, frame), {}, {});
      });
      const Pixels expected = download(two[Role::intrinsic]);
      for (size_t i = 0; i < expected.size(); ++i)
        ASSERT_NEAR(got.intrinsic[i], expected[i], 1e-4 + 1e-3 * expected[i]) << "frame " << k;
    }
  }
}

TEST_F(GlobalTest, AReturningColorIsDetected) {
  const Extent extent{160, 120};
  const Pixels frame = room(extent, 3).frame, gray = colorless(frame);
  GlobalIntrinsic method(device, extent), fresh(device, extent);
  for (int k = 0; k < 14; ++k) decompose(method, gray, extent, gray_light(), {false, true});
  EXPECT_TRUE(last_stats(method).light.gray);
  Result got, expected;
  for (int k = 0; k < 10; ++k) {
    got = decompose(method, frame, extent, gray_light(), {false, true});
    EXPECT_EQ(last_stats(method).light.gray, k < int(gpu::kFramesInFlight));
    expect_product(got, frame);
  }
  for (int k = 0; k < 7; ++k)
    expected = decompose(fresh, frame, extent, gray_light(), {false, true});
  EXPECT_NEAR(got.found.amount, expected.found.amount, 0.05F * expected.found.amount);
  EXPECT_EQ(got.found.colors, expected.found.colors);
  EXPECT_TRUE(got.layers[Role::bases]);
}

TEST_F(GlobalTest, ColorFadesWithoutAJump) {
  const Extent extent{160, 120};
  const Room made = room(extent, 3);
  const Pixels gray = colorless(made.frame);
  // Where the spread of chroma goes through both thresholds, each as often as not conditional.
  float before = 0;
  for (int k = 0; k <= 24; ++k) {
    Pixels frame = made.frame;
    const float share = 0.25F * float(k) / 24;
    for (size_t i = 0; i < frame.size(); ++i) frame[i] = gray[i] + share * (frame[i] - gray[i]);
    GlobalIntrinsic method(device, extent);
    const Result got = decompose(method, frame, extent, to_the_letter(), {true});
    const auto expected = expected_of(frame, extent);
    EXPECT_NEAR(got.found.amount, expected.amount.value, 5e-3) << share;
    EXPECT_NEAR(got.found.confidence, expected.amount.confidence, 5e-3) << share;
    EXPECT_NEAR(got.found.amount, before, 0.25F) << share;
    EXPECT_EQ(got.found.amount > 0, got.found.colors > 0) << share;
    before = got.found.amount;
  }
  EXPECT_GT(before, 0.2F);
}

/// A wall of colored tiles.
Pixels wall(Extent extent) {
  Pixels frame;
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      const uint32_t tile = x / 21 * 5 + y / 17 * 3;
      const float light = 1 - 0.6F * float(x + y) / float(extent.width + extent.height);
      for (uint32_t c = 0; c < 3; ++c) frame.push_back(light * float(2 + tile * (c + 2) % 7) / 9);
      frame.push_back(1);
    }
  return frame;
}

TEST_F(GlobalTest, ACutAfterReusedLightIsSeenInItsOwnLight) {
  const Extent extent{320, 240};
  const auto in_light = [](Pixels frame, float slope) {
    for (size_t i = 0; i < frame.size(); i += 4) {
      const float red = std::pow(frame[i] + frame[i + 1] + frame[i + 2] + 0.01F, 0.5F * slope);
      frame[i] *= red, frame[i + 2] /= red;
    }
    return frame;
  };
  const Pixels still = in_light(wall(extent), 0.6F), other = in_light(room(extent, 3).frame, -0.9F);
  GlobalIntrinsic method(device, extent), fresh(device, extent);
  for (int k = 0; k < 20; ++k) decompose(method, still, extent, {}, {.repeated = k > 0});
  EXPECT_TRUE(last_stats(method).light.reused());
  const Result got = decompose(method, other, extent, {}, {}),
               want = decompose(fresh, other, extent, {}, {true});
  const float k = download(want.layers[Role::slope])[0];
  EXPECT_GT(std::abs(k), 0.1F);
  EXPECT_EQ(download(got.layers[Role::slope])[0], k);
  EXPECT_NEAR(got.found.amount, want.found.amount, 1e-4F);
  EXPECT_LT(rms_difference(got.light, want.light), 0.015);
}

TEST_F(GlobalTest, ReusedLightIsThatOfTheWholeWork) {
  const Extent extent{320, 240};
  const Pixels frame = wall(extent);
  GlobalIntrinsic some(device, extent), all(device, extent);
  GlobalIntrinsic::Params params = gray_light();
  for (int k = 0; k < 24; ++k) {
    const bool shares = k % 2 == 0;
    const Result got =
                     decompose(some, frame, extent, params, {.shares = shares, .repeated = k > 0}),
                 want = decompose(all, frame, extent, params, {.shares = shares});
    EXPECT_FALSE(last_stats(all).light.reused());
    EXPECT_EQ(last_stats(some).light.reused(), k > 12) << k;
    expect_product(got, frame);
    double apart = 0, light = 0;
    for (size_t i = 0; i < frame.size(); ++i) {
      const size_t pixel = i / 4 * 4;
      if (i == pixel + 3) continue;
      light += std::pow(std::log(got.light[i] / want.light[i]), 2) / double(frame.size());
      apart += std::pow(got.light[pixel + 3] - want.light[pixel + 3], 2) / double(frame.size());
    }
    EXPECT_LT(std::sqrt(light), 0.02) << k;
    EXPECT_LT(std::sqrt(apart), 0.05) << k;
    EXPECT_EQ(shares, bool(got.layers[Role::bases]));
    if (!shares) continue;
    // Base colors and their shares make up bounced light as well as without.
    EXPECT_LT(rms_difference(download(got.layers[indirect_role(0)]),
                             download(want.layers[indirect_role(0)])),
              0.05)
        << k;
  }
  // What else the scene becomes concerns everything.
  params.reach = 0.3F;
  decompose(some, frame, extent, params, {.repeated = true});
  EXPECT_FALSE(last_stats(some).light.reused());
}

TEST_F(GlobalTest, ReusedLightIsUnchangedIfNothingChanges) {
  const Extent extent{150, 100};
  const Pixels frame = room(extent, 3).frame;
  GlobalIntrinsic method(device, extent);
  Pixels tint;
  for (int k = 0; k < 24; ++k) {
    const Result got = decompose(method, frame, extent, gray_light(), {.repeated = k > 0});
    EXPECT_EQ(last_stats(method).light.reused(), k > 12) << k;
    Pixels now = got.light;
    for (size_t i = 3; i < now.size(); i += 4) now[i] = 0;  // the direct share follows shading
    EXPECT_TRUE(k < 13 || now == tint) << k;
    tint = now;
  }
}

TEST_F(GlobalTest, AmountSetByHandGoesWithoutColor) {
  const Extent extent{90, 70};
  const Pixels gray = colorless(room(extent, 2).frame);
  GlobalIntrinsic method(device, extent);
  GlobalIntrinsic::Params params = gray_light();
  params.amount = 0.6F;
  Result got;
  for (int k = 0; k < 14; ++k) got = decompose(method, gray, extent, params, {false, true});
  EXPECT_EQ(got.found.amount, 0.6F);
  EXPECT_FALSE(last_stats(method).light.gray);
  double direct = 0;
  for (size_t i = 0; i < gray.size(); i += 4) {
    for (size_t c = 0; c < 3; ++c) ASSERT_NEAR(got.light[i + c], 1, 1e-5);
    direct += got.light[i + 3] / double(extent.pixels());
  }
  EXPECT_LT(direct, 0.8);
}

}  // namespace inverse::testing
