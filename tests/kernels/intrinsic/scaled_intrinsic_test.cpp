// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicdecomp at half the frame's resolution.
#include "kernels/intrinsic/scaled_intrinsic.hpp"

#include "intrinsic_fixture.hpp"
#include "tests/reference/intrinsic/guided_upsample.hpp"

namespace inverse::testing {
namespace {

/// Layers (R.rgb, S) with a shading of both smooth and sudden changes.
Pixels half_layers(Extent half, unsigned seed, float lowest, float highest) {
  Pixels pixels = random_pixels(half, seed);
  for (size_t i = 0; i < half.pixels(); ++i)
    pixels[4 * i + 3] = std::exp(lowest + (highest - lowest) * pixels[4 * i + 3]);
  return pixels;
}

}  // namespace

class ScaledIntrinsicTest : public IntrinsicTest {
 protected:
  Pixels upsample(Extent extent, const Pixels& frame, const Pixels& half) {
    const GuidedUpsample upsample(device, extent);
    const Plane from = plane(extent, frame), layers = plane(half_of(extent), half),
                to = plane(extent);
    run([&](gpu::Commands& commands) {
      upsample.record(commands, from.buffer, layers.buffer, nullptr, to.buffer);
    });
    return download(to);
  }
  void expect_agreement(Extent extent, const Pixels& frame, const Pixels& half) {
    const auto expected = reference::guided_upsample(rgb_of(frame), int(extent.width),
                                                     int(extent.height), log_shading_of(half));
    EXPECT_LE(max_difference(log_shading_of(upsample(extent, frame, half)), expected), 2e-4)
        << name_of(extent);
  }
};

TEST_F(ScaledIntrinsicTest, UpsamplingAgreesWithReference) {
  for (const Extent extent : kOddSizes) {
    expect_agreement(extent, scene(extent, 3), half_layers(half_of(extent), 1, -3, 0.5F));
    // Noise, black pixels, and more light than full scale.
    Pixels harsh = random_pixels(extent, 2, -0.5F, 2.0F);
    for (size_t i = 0; i < harsh.size(); i += 52) harsh[i] = i % 104 ? 1e6F : 0.0F;
    expect_agreement(extent, harsh, half_layers(half_of(extent), 2, -6, 4));
  }
}

TEST_F(ScaledIntrinsicTest, UpsamplingOfInvalidPixelsStaysFinite) {
  const Extent extent{9, 7};
  Pixels frame = scene(extent, 1), half(half_of(extent).pixels() * 4, 0.0F);  // S = 0, too
  frame[0] = kNan, frame[5] = kInf, frame[10] = -kInf;
  EXPECT_TRUE(all_finite(upsample(extent, frame, half)));
}

TEST_F(ScaledIntrinsicTest, HalfResolutionIsNearTheFullOne) {
  const Extent extent{349, 287};
  const Pixels pixels = scene(extent, 5);
  const PlanePtr frame = input(extent, pixels);
  ScaledIntrinsic method(device, extent);
  ScaledIntrinsic::Params params;
  params.light.slope = 0;
  Pixels layers[2];
  for (const bool half : {false, true}) {
    params.half_resolution = half;
    Layers found;
    run([&](gpu::Commands& commands) { found = method.record(commands, frame, params, {true}); });
    layers[half] = download(found[Role::intrinsic]);
    EXPECT_EQ(method.stats(half).halvings, half ? 1U : 0U);
  }
  for (size_t i = 0; i < pixels.size(); ++i)
    if (i % 4 < 3) {
      ASSERT_NEAR(layers[1][i] * layers[1][i | 3], pixels[i], 1e-5) << "R S must be I";
    }
  const double rms = shading_distance(layers[1], layers[0]);
  RecordProperty("rms", std::to_string(rms));
  std::printf("log shading: half from full resolution %.3f rms\n", rms);
  EXPECT_LT(rms, 0.15);
}

TEST_F(ScaledIntrinsicTest, ReflectanceInColoredLightIsTheFrame) {
  const Extent extent{349, 287};
  const Pixels pixels = scene(extent, 5);
  const PlanePtr frame = input(extent, pixels);
  ScaledIntrinsic method(device, extent);
  ScaledIntrinsic::Params params;
  params.light.slope = -0.9F;
  // At each resolution, after a change of it, and where layers fade.
  for (const size_t halvings : {0, 1, 1, 2, 0, 0}) {
    params.set_halvings(halvings);
    Layers found;
    run([&](gpu::Commands& commands) { found = method.record(commands, frame, params, {}); });
    const Pixels layers = download(found[Role::intrinsic]), slope = download(found[Role::slope]);
    const reference::LightColor light{double(slope[0]), 0, double(slope[1])};
    EXPECT_EQ(slope[0], -0.9F);
    for (size_t i = 0; i < pixels.size(); i += 4) {
      const auto gray =
          reference::in_gray_light({layers[i], layers[i + 1], layers[i + 2], layers[i + 3]}, light);
      for (size_t c = 0; c < 3; ++c)
        ASSERT_NEAR(gray[c] * gray[3], pixels[i + c], 1e-5) << halvings << " halvings";
    }
  }
}

TEST_F(ScaledIntrinsicTest, TheScaleOfTheOutputSurvivesAChangeOfResolution) {
  const Extent extent{160, 120};
  ScaledIntrinsic method(device, extent);
  ScaledIntrinsic::Params params;
  const PlanePtr bright = input(extent, scene(extent, 1));
  Pixels dim = scene(extent, 1);
  for (float& v : dim) v *= 0.5F;
  const auto scale_of = [&](const PlanePtr& frame, bool half, bool reset) {
    params.half_resolution = half;
    run([&](gpu::Commands& commands) { method.record(commands, frame, params, {reset}); });
    return method.findings(method.recorded() - 1).scale;
  };
  const float first = scale_of(bright, false, true);
  const float at_full = scale_of(input(extent, dim), false, false);
  EXPECT_NEAR(at_full, first, 0.05F) << "half the light is no other reflectance";
  // The frame after a change of resolution starts with the scale that it takes over.
  const float at_half = scale_of(bright, true, false);
  EXPECT_NEAR(at_half, at_full, 0.05F);
  EXPECT_NEAR(scale_of(bright, false, false), at_half, 0.05F);
  EXPECT_NE(scale_of(input(extent, Pixels(dim.size(), 0.2F)), true, true), first);  // anew
}

}  // namespace inverse::testing
