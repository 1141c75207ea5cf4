// SPDX-License-Identifier: LGPL-2.1-or-later
// The slope of the color of light against tests/reference/intrinsic/scene_light.*.
#include "intrinsic_fixture.hpp"
#include "kernels/intrinsic/light_color/scene_light.hpp"
#include "kernels/solve/scale_normalization.hpp"
#include "tests/reference/intrinsic/scene_light.hpp"

namespace inverse::testing {
namespace {

using State = shaders::intrinsic_light_color_scene;
using Scale = shaders::solve_scale_update;

/// The scene with light of this slope: brighter light is redder if it is positive.
Pixels in_light(Extent extent, unsigned seed, float slope) {
  Pixels pixels = scene(extent, seed);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      float* pixel = &pixels[4 * (size_t{y} * extent.width + x)];
      const float red = std::exp(0.5F * slope *
                                 std::log((x + 2 * y > extent.width ? 0.9F : 0.35F) *
                                          (1 - 0.4F * float(y) / float(extent.height))));
      pixel[0] *= red;
      pixel[2] /= red;
    }
  return pixels;
}

}  // namespace

class LightColorTest : public IntrinsicTest {
 protected:
  /// LIGHT_… of a frame. `brighter`: how its exposure changes, as ScaleNormalization finds it.
  Pixels record(SceneLight& light, Extent extent, const Pixels& pixels, bool first,
                std::optional<float> slope = {}, float brighter = 0) {
    const Plane frame = plane(extent, pixels);
    Pixels scale(4 * Scale::SCALE_SIZE);
    scale[4 * Scale::SCALE_LIGHT + 3] = brighter;
    const auto uploaded = upload(scale);
    run([&](gpu::Commands& commands) {
      light.record(commands, frame.buffer, {slope}, first);
      light.record_move(commands, false);
      light.record_slope(commands, uploaded);
    });
    return download(light.state());
  }
};

TEST_F(LightColorTest, AgreesWithReference) {
  for (const Extent extent : {Extent{349, 287}, Extent{96, 72}, Extent{61, 130}, Extent{5, 3},
                              Extent{1, 1}, Extent{1000, 2}}) {
    SceneLight light(device, extent);
    reference::SceneLight expected(SceneLight::weights());
    for (int k = 0; k < 20; ++k) {
      // Frames of a scene whose light changes a little, a slope that is given for a while, a cut,
      // hostile pixels.
      Pixels pixels = in_light(extent, k < 12 ? 3 : 4, k < 12 ? 0.5F : -0.8F);
      for (float& v : pixels) v *= 1 + 0.01F * float(k % 5);
      if (k == 15)
        for (size_t i = 0; i < pixels.size(); i += 7) pixels[i] = i % 2 ? kNan : 1e9F;
      const bool first = k == 0 || k == 18;
      const float brighter = k % 3 == 0 ? 0.015F : k == 7 ? -0.4F : 0;
      const std::optional<float> given = k == 6 || k == 7 ? std::optional(0.4F)
                                         : k == 13        ? std::optional(-1.5F)
                                                          : std::nullopt;
      const Pixels got = record(light, extent, pixels, first, given, brighter);
      const auto& want = expected.update(
          rgb_of(pixels).data(), int(extent.width), int(extent.height), first,
          first || k % SceneLight::kPeriod == 0 || (k > 18 && (k - 18) % SceneLight::kPeriod == 0),
          given);
      const std::string what = name_of(extent) + ", frame " + std::to_string(k);
      EXPECT_EQ(uint32_t(got[4 * State::LIGHT_TARGET + 3]), uint32_t(want.did)) << what;
      EXPECT_NEAR(got[0], want.slope, 8e-3) << what;
      EXPECT_NEAR(got[1], want.reference, 1e-4) << what;
      EXPECT_NEAR(got[4], want.target, 8e-3) << what;
      EXPECT_NEAR(got[5], want.spread, 4e-3) << what;
      // It changes five times as fast as the spread.
      EXPECT_NEAR(got[2], want.confidence, 2e-2) << what;
      EXPECT_EQ(int(got[6]), want.measurements) << what;
      expected.expose(static_cast<double>(brighter));
    }
  }
}

TEST_F(LightColorTest, TheFirstSolverOfAFrameDecidesWhetherLightMoves) {
  const Extent extent{96, 72};
  SceneLight light(device, extent);
  const Pixels before = record(light, extent, in_light(extent, 3, 0.5F), true);
  const Plane other = plane(extent, in_light(extent, 4, -0.8F));
  run([&](gpu::Commands& commands) {
    light.record(commands, other.buffer, {}, false);
    light.record_move(commands, true);
    light.record_move(commands, false);
  });
  const Pixels kept = download(light.state());
  EXPECT_EQ(kept[0], before[0]);
  run([&](gpu::Commands& commands) {
    light.record(commands, other.buffer, {}, false);
    light.record_move(commands, false);
    light.record_move(commands, true);
  });
  EXPECT_NE(download(light.state())[0], before[0]) << "the new scene's, once a frame allows it";
}

TEST_F(LightColorTest, AGivenSlopeIsInForceAtOnce) {
  const Extent extent{64, 48};
  SceneLight light(device, extent);
  const Pixels first = record(light, extent, scene(extent, 1), true, 0.2F);
  for (const float slope : {0.7F, -1.5F, 5.0F}) {
    Pixels pixels = scene(extent, 1);
    for (float& v : pixels) v *= 0.9F;
    const Pixels got = record(light, extent, pixels, false, slope);
    EXPECT_EQ(got[0], std::min(slope, SceneLight::kMaxSlope));
    EXPECT_EQ(got[2], 1);
    EXPECT_EQ(got[1], first[1]) << "white light is that of the scene";
  }
}

TEST_F(LightColorTest, FramesWithoutColorOrContrastHaveGrayLight) {
  const Extent extent{64, 48};
  Pixels gray = scene(extent, 1);
  for (size_t i = 0; i < gray.size(); i += 4) gray[i + 1] = gray[i + 2] = gray[i];
  Pixels even(gray.size());  // colors of one brightness
  for (size_t i = 0; i < even.size(); i += 4) {
    const float redder = i / 32 % 2 ? 1.3F : 0.8F;
    even[i] = 0.4F * redder, even[i + 1] = 0.4F, even[i + 2] = 0.4F / redder;
  }
  using Did = SceneLight::Did;
  const struct {
    Pixels pixels;
    Did did;
  } frames[] = {{gray, Did::no_color},
                {Pixels(gray.size(), 0.0F), Did::no_color},
                {Pixels(gray.size(), kNan), Did::no_color},
                {Pixels(gray.size(), 1e9F), Did::no_color},
                {even, Did::no_contrast}};
  for (const auto& frame : frames) {
    SceneLight light(device, extent);
    const Pixels got = record(light, extent, frame.pixels, true);
    EXPECT_EQ(got[0], 0);
    EXPECT_EQ(uint32_t(got[4 * State::LIGHT_TARGET + 3]), uint32_t(frame.did));
    EXPECT_TRUE(all_finite(got));
  }
}

}  // namespace inverse::testing
