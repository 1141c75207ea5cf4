// SPDX-License-Identifier: LGPL-2.1-or-later
// The key: kernels against their specification, mixtures against the alpha that they are made with.
#include "kernels/edit/key/key.hpp"

#include <cmath>

#include "tests/kernels/edit/edit_fixture.hpp"
#include "tests/reference/edit/key.hpp"

namespace inverse::testing {
namespace {

constexpr float kScreen[3] = {.05F, .34F, .09F};

/// Light and reflectance of a screen with a disk and noise before it.
struct Scene {
  Pixels frame, intrinsic;

  Scene(Extent extent, unsigned seed, bool hostile) {
    std::mt19937 random(seed);
    const auto between = [&](float a, float b) {
      return a + (b - a) * static_cast<float>(random() % 65536) / 65535.F;
    };
    for (uint32_t y = 0; y < extent.height; ++y)
      for (uint32_t x = 0; x < extent.width; ++x) {
        const float u = static_cast<float>(x) / static_cast<float>(extent.width) - .5F;
        const float v = static_cast<float>(y) / static_cast<float>(extent.height) - .4F;
        const float alpha = std::clamp(8 * (.3F - std::hypot(u, v)), 0.F, 1.F);
        const float light = (1 + u) * between(.97F, 1.03F);
        for (int c = 0; c < 4; ++c) {
          const float front = c < 3 ? .2F + .2F * static_cast<float>(c == 0) : 1;
          const float paint = c < 3 ? alpha * front + (1 - alpha) * kScreen[c] : light;
          frame.push_back(c < 3 ? light * paint : between(.5F, 1));
          intrinsic.push_back(paint);
        }
      }
    if (!hostile) return;
    frame = with_extremes(std::move(frame), seed + 1);
    intrinsic = with_extremes(std::move(intrinsic), seed + 2);
  }
};

reference::KeySpec spec_of(const KeyParams& p) {
  return {{p.key[0], p.key[1], p.key[2]},
          p.of_border,
          p.tolerance,
          p.black,
          p.white,
          p.despill,
          p.shrink,
          p.strength,
          p.invert};
}

}  // namespace

class KeyTest : public GpuTest {
 protected:
  Layers layers(Extent extent, const Scene& scene) {
    return intrinsic_layers(shared_plane(extent, scene.frame),
                            shared_plane(extent, scene.intrinsic), nullptr);
  }
  struct Result {
    Pixels mask, picture, screen;
  };
  Result record(Layers frame, const KeyParams& params, bool over_black = false) {
    Key key(device, frame.extent);
    PlanePtr picture;
    run([&](gpu::Commands& commands) {
      key.record(commands, frame, params);
      picture = key.draw(commands, frame, params, over_black);
    });
    return {frame[Role::mask] ? download(frame[Role::mask]) : Pixels{}, download(picture),
            download(key.screen())};
  }
  void expect_reference(Extent extent, const Scene& scene, const KeyParams& params,
                        const std::string& what, const Pixels& mask = {},
                        const Pixels& edited = {}) {
    Layers frame = layers(extent, scene);
    if (!mask.empty()) frame[Role::mask] = shared_plane(extent, mask);
    if (!edited.empty()) frame[Role::intrinsic] = shared_plane(extent, edited);
    Pixels composed;
    if (!edited.empty()) {
      Compose compose(device, extent);
      composed =
          result_of([&](gpu::Commands& commands) { return compose.record(commands, frame, {}); });
    }
    for (const bool over_black : {false, true}) {
      const Result got = record(frame, params, over_black);
      const auto seen = to_reference(extent, scene.frame);
      const auto paint = to_reference(extent, scene.intrinsic);
      const reference::KeySpec spec = spec_of(params);
      const auto screen = reference::screen_of(paint, spec);
      for (size_t c = 0; c < 4; ++c)
        ASSERT_NEAR(double{got.screen[c]}, screen[c], 1e-3 * (1 + screen[c])) << what << " screen";
      const int side = static_cast<int>(Key::grid_of(extent).side);
      const auto light = reference::key_light(seen, paint, screen, side, spec.tolerance);
      const auto came_in = mask.empty() ? reference::Plane() : to_reference(extent, mask);
      const auto matte =
          reference::key_matte(seen, paint, light, side, mask.empty() ? nullptr : &came_in, spec);
      const auto shrunk = reference::shrunk(matte, params.invert ? -spec.shrink : spec.shrink);
      ASSERT_NO_FATAL_FAILURE(expect_near(got.mask, shrunk, 4e-3, what + " mask"));
      const auto drawn = edited.empty() ? reference::Plane() : to_reference(extent, composed);
      ASSERT_NO_FATAL_FAILURE(
          expect_near(got.picture,
                      reference::keyed_picture(seen, edited.empty() ? nullptr : &drawn, light, side,
                                               matte, shrunk, spec, over_black),
                      1e-2, what + " picture"));
    }
  }
};

TEST_F(KeyTest, AgreesWithReference) {
  for (const Extent extent : kOddSizes)
    for (const bool hostile : {false, true})
      for (const bool of_border : {false, true}) {
        if (extent.pixels() > 50000 && (of_border || hostile)) continue;
        ASSERT_NO_FATAL_FAILURE(expect_reference(
            extent, Scene(extent, extent.width + 1, hostile), {.of_border = of_border},
            name_of(extent) + (hostile ? " hostile" : "") + (of_border ? " border" : "")));
      }
}

TEST_F(KeyTest, EverySettingAgreesWithReference) {
  const Extent extent{61, 43};
  const Scene scene(extent, 5, false);
  const Pixels mask = random_pixels(extent, 3, -.2F, 1.2F);
  Pixels edited = scene.intrinsic;
  for (float& p : edited) p *= .7F;
  for (const KeyParams& params :
       {KeyParams{.tolerance = .05F, .black = .3F, .white = .6F},
        KeyParams{.black = .5F, .white = .5F}, KeyParams{.despill = .4F, .strength = .6F},
        KeyParams{.shrink = 1.3F}, KeyParams{.shrink = -2.6F}, KeyParams{.invert = true},
        KeyParams{.shrink = 2, .invert = true, .strength = .5F}, KeyParams{.shrink = 16}}) {
    ASSERT_NO_FATAL_FAILURE(expect_reference(extent, scene, params, "setting"));
    ASSERT_NO_FATAL_FAILURE(expect_reference(extent, scene, params, "masked", mask));
    ASSERT_NO_FATAL_FAILURE(expect_reference(extent, scene, params, "edited", {}, edited));
  }
}

// Any noise: no screen, or one of few pixels.
TEST_F(KeyTest, NoiseGivesMattesWithinRange) {
  for (const float high : {1.F, 1e-4F, 60000.F}) {
    const Extent extent{97, 51};
    Scene scene(extent, 1, false);
    scene.frame = random_pixels(extent, 1, -.1F * high, high);
    scene.intrinsic = random_pixels(extent, 2, -.1F * high, high);
    const Result got = record(layers(extent, scene), {.of_border = high < 1, .tolerance = 2});
    EXPECT_TRUE(are_light(got.picture)) << high;
    EXPECT_TRUE(all_finite(got.mask)) << high;
    for (size_t i = 0; i < got.mask.size(); i += 4) {
      ASSERT_GE(got.mask[i], 0);
      ASSERT_LE(got.mask[i], 1);
    }
  }
}

// Strands thinner than a pixel, gray, before a screen of uneven light: alpha is that of the
// mixture.
TEST_F(KeyTest, ThinStrandsHaveTheAlphaOfTheirMixture) {
  const Extent extent{120, 80};
  Scene scene(extent, 1, false);
  for (const int c : {0, 1, 2}) {  // the hue of the screen
    const float screen = kScreen[static_cast<size_t>((c + 1) % 3)];
    EXPECT_GT(screen, 0);
    std::vector<double> wanted;
    scene.frame.clear();
    scene.intrinsic.clear();
    for (uint32_t y = 0; y < extent.height; ++y)
      for (uint32_t x = 0; x < extent.width; ++x) {
        const float alpha =
            x % 12 == 5 && y > 20 && y < 60 ? .1F + .8F * static_cast<float>(y - 20) / 40 : 0;
        const float light = .6F + .4F * static_cast<float>(x) / 120;
        wanted.push_back(alpha);
        for (size_t k = 0; k < 4; ++k) {
          const float paint = k < 3 ? kScreen[(k + static_cast<size_t>(c)) % 3] : 1;
          const float seen = k < 3 ? alpha * .1F + (1 - alpha) * light * paint : 1;
          scene.frame.push_back(seen);
          scene.intrinsic.push_back(k < 3 ? seen / light : light);
        }
      }
    const Result got = record(layers(extent, scene),
                              {.key = {kScreen[c % 3], kScreen[(c + 1) % 3], kScreen[(c + 2) % 3]},
                               .black = 0,
                               .white = 1});
    for (size_t n = 0; n < wanted.size(); ++n) {
      ASSERT_NEAR(got.mask[4 * n], wanted[n], .04) << n % extent.width << ", " << n / extent.width;
      if (wanted[n] <= .5) continue;
      for (size_t k = 0; k < 3; ++k) ASSERT_NEAR(got.picture[4 * n + k], .1F, .02F) << n;
    }
  }
}

TEST_F(KeyTest, GrayAndScreenlessFramesAreForeground) {
  const Extent extent{40, 30};
  Scene scene(extent, 1, false);
  for (size_t i = 0; i < scene.frame.size(); ++i) scene.frame[i] = scene.intrinsic[i] = .3F;
  for (const bool of_border : {false, true}) {
    const Result got = record(layers(extent, scene), {.of_border = of_border});
    EXPECT_EQ(got.screen[3], 0);
    for (size_t i = 0; i < got.mask.size(); i += 4) ASSERT_EQ(got.mask[i], 1);
    for (size_t i = 0; i < got.picture.size(); ++i) ASSERT_NEAR(got.picture[i], .3F, 1e-6F);
  }
}

TEST_F(KeyTest, NeutralRecordsNothing) {
  const Extent extent{40, 30};
  const Scene scene(extent, 1, false);
  Layers frame = layers(extent, scene);
  Key key(device, extent);
  run([&](gpu::Commands& commands) {
    key.record(commands, frame, {.strength = 0});
    EXPECT_EQ(key.draw(commands, frame, {.strength = 0}, false), frame[Role::input]);
    EXPECT_EQ(commands.dispatches(), 0U);
  });
  EXPECT_EQ(frame[Role::mask], nullptr);
}

TEST_F(KeyTest, TheScreenIsFollowedAndForgotten) {
  const Extent extent{64, 48};
  Scene scene(extent, 1, false);
  Key key(device, extent);
  const auto green = [&] {
    Layers frame = layers(extent, scene);
    run([&](gpu::Commands& commands) { key.record(commands, frame, {}); });
    return download(key.screen())[1];
  };
  const float before = green();
  for (float& p : scene.intrinsic) p *= 1.4F;
  const float after = green();
  EXPECT_NEAR(after, before * (1 + .4F / 8), 1e-3F);
  key.reset();
  EXPECT_NEAR(green(), before * 1.4F, 1e-3F);
  // What covers the screen for a while does not make it forgotten.
  for (float& p : scene.intrinsic) p = .2F;
  EXPECT_NEAR(green(), before * 1.4F, 1e-3F);
}

}  // namespace inverse::testing
