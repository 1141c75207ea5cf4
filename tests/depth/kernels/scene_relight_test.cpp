// SPDX-License-Identifier: LGPL-2.1-or-later
// Lamps in a remembered scene: the kernels against their specification, and what no scene may
// break.
#include "kernels/edit/relight/relight.hpp"
#include "tests/depth/kernels/remembered_room.hpp"
#include "tests/reference/edit/scene_light.hpp"

namespace inverse::testing {
namespace {

reference::SceneLamp specified(const Lamp& lamp) {
  reference::SceneLamp result{.kind = static_cast<reference::SceneLamp::Kind>(lamp.kind)};
  double length = 0;
  for (const float v : lamp.direction) length += double{v} * double{v};
  for (size_t c = 0; c < 3; ++c) {
    result.place[c] = double{lamp.position[c]};
    result.axis[c] = double{lamp.direction[c]} / std::sqrt(length);
    result.light[c] = double{lamp.power};
  }
  result.angle = double{lamp.angle} * 3.14159265358979323846 / 180;
  result.softness = double{lamp.softness};
  result.radius = double{lamp.radius};
  return result;
}

class SceneRelightTest : public RememberedRoom {
 protected:
  std::shared_ptr<SeenScene> scene(const Pixels& surface, const Volume& volume, bool found = true) {
    return RememberedRoom::scene(kCamera, surface, volume, found);
  }
  /// The mean light of lamps alone on each pixel of a frame of white surfaces.
  std::vector<float> light(const std::shared_ptr<SeenScene>& scene, RelightParams params,
                           Extent extent = extent_of(kCamera)) {
    Layers layers{extent, {}};
    layers[Role::intrinsic] = shared_plane(extent, Pixels(4 * extent.pixels(), 1));
    layers.scene = scene;
    params.ambient = 0;
    Relight relight(device, extent);
    run([&](gpu::Commands& commands) { relight.record(commands, layers, params); });
    const Pixels pixels = download(layers[Role::intrinsic]);
    EXPECT_TRUE(are_light(pixels));
    std::vector<float> result;
    for (size_t i = 3; i < pixels.size(); i += 4) result.push_back(pixels[i]);
    return result;
  }
  std::vector<double> specified_light(const Pixels& surface, const std::vector<Lamp>& lamps,
                                      bool shadows) {
    std::vector<reference::SceneLamp> all;
    for (const Lamp& lamp : lamps) all.push_back(specified(lamp));
    std::vector<double> result;
    for (const auto& sum : reference::scene_light(
             kCamera, to_reference(extent_of(kCamera), surface), all, expected_, shadows))
      result.push_back((sum[0] + sum[1] + sum[2]) / 3);
    return result;
  }
};

/// Lamps over the ball, low beside the box, a spot from the camera and the sun; then those that are
/// in awkward places: in the floor, on it, behind the camera, far away, in the ball.
std::vector<Lamp> lamps_of_room() {
  using Kind = Lamp::Kind;
  return {{.position = {0.7F, -0.3F, 1.5F}, .power = 0.5F, .room = true},
          {.position = {-0.1F, 0.8F, 1.2F}, .power = 0.2F, .radius = 0.1F, .room = true},
          {.kind = Kind::spot,
           .position = {-0.6F, -0.2F, 0.3F},
           .direction = {.3F, .4F, 1},
           .power = 2,
           .room = true},
          {.kind = Kind::directional, .direction = {1, 2, .5F}, .power = 1, .room = true},
          {.position = {0, 1.1F, 1.5F}, .power = 1, .room = true},
          {.position = {0, 1, 1.5F}, .power = 1, .room = true},
          {.position = {0, 0, -3}, .power = 3, .room = true},
          {.position = {-900, -1000, 1000}, .power = 1e6F, .room = true},
          {.position = {0.3F, 0.65F, 1.7F}, .power = 1, .radius = 0, .room = true}};
}

}  // namespace

TEST_F(SceneRelightTest, AgreesWithSpecification) {
  for (const Lamp& lamp : lamps_of_room()) {
    const auto got = light(scene(surface_, *volume_), {.lamps = {lamp}}),
               plain = light(scene(surface_, *volume_), {.lamps = {lamp}, .shadows = false});
    const auto with = specified_light(surface_, {lamp}, true),
               without = specified_light(surface_, {lamp}, false);
    size_t off_plain = 0, lit = 0, dark = 0, off_marched = 0, lit_marched = 0, off_between = 0;
    const auto off_at = [&](int x, int y) {
      const size_t n = size_t(y) * size_t(kCamera.width) + size_t(x);
      return std::abs(double{got[n]} - with[n]) > 0.1 * without[n] + 1e-6;
    };
    for (int y = 0; y < kCamera.height; ++y)
      for (int x = 0; x < kCamera.width; ++x) {
        const size_t n = size_t(y) * size_t(kCamera.width) + size_t(x);
        lit += without[n] > 0;
        dark += with[n] < 0.5 * without[n];
        ASSERT_LE(got[n], plain[n]);
        // The volumes differ in a few voxels, and rays of the kernel take longer steps, which may
        // pass the corner of what was seen of a thing: many do on the way to a lamp in it.
        off_plain += std::abs(double{plain[n]} - without[n]) > 0.01 * without[n] + 1e-6;
        const bool marched = x % 2 == 0 && y % 2 == 0;
        lit_marched += marched && without[n] > 0;
        off_marched += marched && off_at(x, y);
        // What is between pixels with a ray is as these are.
        bool off_around = false;
        for (int v = y - y % 2; v <= std::min(y + y % 2, kCamera.height - 1); v += 2)
          for (int u = x - x % 2; u <= std::min(x + x % 2, kCamera.width - 1); u += 2)
            off_around = off_around || off_at(u, v);
        off_between += !off_around && off_at(x, y);
      }
    const std::string what = "lamp at " + std::to_string(lamp.position[0]) + ", " +
                             std::to_string(lamp.position[1]) + ", " +
                             std::to_string(lamp.position[2]);
    EXPECT_GT(dark, 20U) << what;
    EXPECT_LE(off_marched, lit_marched / 20) << what;
    EXPECT_LE(off_between, lit / 50) << what;
    EXPECT_LE(off_plain, lit / 50) << what;
  }
}

TEST_F(SceneRelightTest, ShadowsAreWhereTheSceneIsInTheWay) {
  // What the exact scene casts from a lamp, on surfaces that are not at an edge of the shadow.
  const Lamp lamp{.position = {-0.1F, 0.8F, 1.2F}, .power = 1, .room = true};
  const auto got = light(scene(surface_, *volume_), {.lamps = {lamp}}),
             free = light(scene(surface_, *volume_), {.lamps = {lamp}, .shadows = false});
  size_t both = 0, either = 0, counted = 0;
  for (int y = 0; y < kCamera.height; ++y)
    for (int x = 0; x < kCamera.width; ++x) {
      const size_t n = size_t(y) * size_t(kCamera.width) + size_t(x);
      if (!(free[n] > 0.02F)) continue;
      const double depth = double{surface_[4 * n + 3]};
      Vec3 at = kCamera.ray(x, y), normal{}, to{};
      for (double& v : at) v *= depth;
      at = kCamera.to_world(at);
      normal = kCamera.turned(
          {double{surface_[4 * n]}, double{surface_[4 * n + 1]}, double{surface_[4 * n + 2]}});
      for (size_t c = 0; c < 3; ++c) {
        at[c] += 0.03 * normal[c];
        to[c] = double{lamp.position[c]} - at[c];
      }
      const bool dark = trace(Scene::room, at, to).along < 1, found = got[n] < free[n] / 2;
      both += dark && found;
      either += dark || found;
      ++counted;
    }
  EXPECT_GT(either, counted / 20) << "a lamp without shadows tests nothing";
  EXPECT_GT(double(both), 0.8 * double(either));
}

TEST_F(SceneRelightTest, SurfacesThatAreNoneAreNotLit) {
  Pixels broken = surface_;
  std::mt19937 random(3);
  const float extremes[] = {kNan, -kNan, kInf, -kInf, 0, -1, 1e30F, 1e-30F};
  for (size_t n = 0; n < broken.size(); n += 4)
    if (random() % 4 == 0) broken[n + random() % 4] = extremes[random() % std::size(extremes)];
  const Lamp lamp = lamps_of_room()[0];
  const auto whole = light(scene(surface_, *volume_), {.lamps = {lamp}}),
             got = light(scene(broken, *volume_), {.lamps = {lamp}});
  const auto same_at = [&](int x, int y) {
    const int n = 4 * (y * kCamera.width + x);
    return std::equal(&broken[size_t(n)], &broken[size_t(n)] + 4, &surface_[size_t(n)]);
  };
  // Shadows and normals are those of the pixels around it, too.
  const auto same_around = [&](int n) {
    const int x = n % kCamera.width, y = n / kCamera.width;
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, kCamera.height - 1); ++v)
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, kCamera.width - 1); ++u)
        if (!same_at(u, v)) return false;
    return true;
  };
  size_t dark = 0, same = 0;
  for (size_t n = 0; n < got.size(); ++n) {
    if (same_around(int(n))) {
      ASSERT_EQ(got[n], whole[n]) << n;
      ++same;
    }
    const float depth = broken[4 * n + 3];
    if (!(depth > 0 && depth < 65504) || std::isnan(broken[4 * n])) {
      ASSERT_EQ(got[n], 0) << n;
      ++dark;
    }
  }
  EXPECT_GT(dark, got.size() / 20);
  EXPECT_GT(same, got.size() / 100);
}

TEST_F(SceneRelightTest, AnEmptyVolumeCastsNoShadow) {
  const Volume empty(device, kParams);
  for (const Lamp& lamp : lamps_of_room()) {
    const auto got = light(scene(surface_, empty), {.lamps = {lamp}}),
               free = light(scene(surface_, empty), {.lamps = {lamp}, .shadows = false});
    EXPECT_EQ(got, free);
  }
}

TEST_F(SceneRelightTest, LampsAreOffWhereTheCameraIsLostOrNoSceneIs) {
  const std::vector<Lamp> lamps = lamps_of_room();
  const RelightParams params{.lamps = {lamps.begin(), lamps.begin() + 4}};
  for (const float v : light(scene(surface_, *volume_, false), params)) ASSERT_EQ(v, 0);
  for (const float v : light(nullptr, params)) ASSERT_EQ(v, 0);
}

// A lamp over the picture at the depth of one in the room, on its pixel, is that lamp.
TEST_F(SceneRelightTest, LampsOverThePictureStandInTheScene) {
  const Extent extent{128, 96};  // another size than the view
  const Vec3 seen = kCamera.to_camera({0.3, 0.1, 1.3});
  Lamp over{.position = {float(2 * (kCamera.fx * seen[0] / seen[2] + kCamera.cx + .5)),
                         float(2 * (kCamera.fy * seen[1] / seen[2] + kCamera.cy + .5)),
                         float(1.7 - seen[2])},
            .power = .5F};
  const Lamp room{.position = {.3F, .1F, 1.3F}, .power = .5F, .room = true};
  const auto a = light(
                 scene(surface_, *volume_),
                 {.lamps = {over}, .surface = RelightParams::Surface::scene, .plane_depth = 1.7F},
                 extent),
             b = light(scene(surface_, *volume_), {.lamps = {room}}, extent);
  size_t off = 0;
  for (size_t n = 0; n < a.size(); ++n) off += std::abs(a[n] - b[n]) > 1e-3F * (1 + b[n]);
  EXPECT_LT(off, a.size() / 500);
}

TEST_F(SceneRelightTest, MarkersAreWhereLampsAreSeen) {
  const Extent extent = extent_of(kCamera);
  const Vec3 seen = kCamera.to_camera({-0.1, 0.5, 1.2});
  const auto x = std::lround(kCamera.fx * seen[0] / seen[2] + kCamera.cx),
             y = std::lround(kCamera.fy * seen[1] / seen[2] + kCamera.cy);
  Layers layers = intrinsic_layers(shared_plane(extent, Pixels(4 * extent.pixels(), .5F)),
                                   shared_plane(extent, Pixels(4 * extent.pixels(), .5F)), nullptr);
  layers.scene = scene(surface_, *volume_);
  Relight relight(device, extent);
  run([&](gpu::Commands& commands) {
    relight.record(commands, layers,
                   {.lamps = {{.position = {-.1F, .5F, 1.2F}, .power = 0, .room = true},
                              {.position = {0, 0, -2}, .power = 0, .room = true}},
                    .markers = true});
  });
  const Pixels got = download(layers[Role::intrinsic]);
  size_t marked = 0;
  for (size_t n = 0; n < extent.pixels(); ++n) marked += got[4 * n] != .5F;
  EXPECT_EQ(got[4 * (size_t(y) * extent.width + size_t(x))], 1);
  EXPECT_GT(marked, 4U);
  EXPECT_LT(marked, 30U) << "the lamp behind the camera has a mark";
}

}  // namespace inverse::testing
