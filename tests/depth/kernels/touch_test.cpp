// SPDX-License-Identifier: LGPL-2.1-or-later
// What is in front of a scene, and what of it touches that, against their specification.
#include "tests/depth/reference/touch.hpp"

#include <cmath>
#include <limits>
#include <random>

#include "kernels/depth/touch/touch_finder.hpp"
#include "tests/depth/kernels/volume_fixture.hpp"

namespace inverse::testing {
namespace {

using reference::TouchKind;
using Shader = shaders::depth_touch_compare;

constexpr std::array<float, 4> kSkin{0.4F, 0.2F, 0.12F, 1}, kCloth{0.1F, 0.1F, 0.3F, 1};

/// What a finder is shown.
struct Input {
  Camera camera;
  std::vector<double> depth, view;
  reference::Plane layers, normals, reflectance;

  explicit Input(const Camera& of)
      : camera(of),
        depth(size_t(of.width) * size_t(of.height)),
        view(depth.size()),
        layers(of.width, of.height),
        normals(of.width, of.height),
        reflectance(of.width, of.height) {
    for (auto& normal : normals.data) normal = {0, 0, -1, 0};
  }
};

std::vector<float> narrow(const std::vector<double>& values) {
  return {values.begin(), values.end()};
}
TouchKind kind_of(uint32_t word) {
  return {(word & Shader::TOUCH_FRONT) != 0, (word & Shader::TOUCH_MAYBE) != 0,
          (word & Shader::TOUCH_SKIN) != 0};
}

class TouchTest : public VolumeFixture {
 protected:
  struct Output {
    std::vector<TouchKind> kinds;
    std::vector<float> result, kept;
  };
  Output find(const Input& in, bool found = true) {
    const Extent extent = extent_of(in.camera);
    const auto pixels = uint32_t(extent.pixels());
    reference::Plane surface(in.camera.width, in.camera.height);
    for (size_t i = 0; i < surface.size(); ++i) surface.data[i][3] = in.depth[i];
    Volume::View view(device, extent);
    view.depth = upload(gpu::Element::scalar, narrow(in.view).data(), pixels);
    view.surface = upload(to_pixels(in.normals));
    view.reflectance = upload(to_pixels(in.reflectance));
    Pixels valid(16, 0);
    valid[0] = found;
    const auto depth = gpu::Buffer::create(device, gpu::Element::scalar, pixels),
               given = upload(gpu::Element::scalar, narrow(in.depth).data(), pixels);
    // Of all frames of one size, which must not show what was found before.
    if (!finder_ || finder_->first != extent)
      finder_.emplace(extent, std::make_unique<TouchFinder>(device, extent));
    TouchFinder& finder = *finder_->second;
    run([&](gpu::Commands& commands) {
      commands.copy(given, depth, depth->bytes());
      finder.record(commands,
                    {.lens = lens_of(in.camera),
                     .pose = pose_of(in.camera),
                     .surface = upload(to_pixels(surface)),
                     .layers = upload(to_pixels(in.layers)),
                     .found = upload(valid)},
                    view);
      finder.record_background(commands, depth);
    });
    Output out{{}, download(finder.result()), download(depth)};
    for (const uint32_t word : words(finder.kinds())) out.kinds.push_back(kind_of(word));
    return out;
  }

  std::optional<std::pair<Extent, std::unique_ptr<TouchFinder>>> finder_;

  /// The same by the specification, with the kinds of the kernel where these are a matter of
  /// rounding.
  static void compare(const Input& in, const Output& out) {
    const int width = in.camera.width, height = in.camera.height;
    auto kinds = reference::compare(width, height, in.depth, in.view, in.layers);
    for (int pass = 0; pass < 8; ++pass) kinds = reference::grow(width, height, in.depth, kinds);
    size_t other = 0;
    for (size_t i = 0; i < kinds.size(); ++i) other += kinds[i] != out.kinds[i];
    EXPECT_LE(other, kinds.size() / 500) << "of " << kinds.size();
    const auto kept = reference::background(width, height, in.depth, out.kinds);
    for (size_t i = 0; i < kept.size(); ++i) ASSERT_EQ(out.kept[i], float(kept[i])) << i;
    const auto expected =
        reference::touch(in.camera, in.depth, in.view, in.normals, in.reflectance, out.kinds);
    EXPECT_NEAR(double{out.result[10]}, expected.front, 1e-5);
    EXPECT_NEAR(double{out.result[3]}, expected.area, 1e-3 * expected.area + 1e-12);
    if (!(expected.area > 0)) return;
    for (size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(double{out.result[c]}, expected.place[c], 1e-3);
      EXPECT_NEAR(double{out.result[4 + c]}, expected.color[c], 1e-3);
    }
    EXPECT_EQ(out.result[7] > 0, expected.colored);
    EXPECT_NEAR(double{out.result[8]}, expected.distance, 1e-5);
    EXPECT_NEAR(double{out.result[9]}, expected.pixels, 0.5);
  }
};

Camera ahead(int width, int height) {
  return camera_at(width, height, {0.1, -0.2, 0.05}, {0.3, 0.1, 2});
}

void paint(reference::Plane& plane, size_t at, const std::array<float, 4>& color) {
  for (size_t c = 0; c < 4; ++c) plane.data[at][c] = double{color[c]};
}

/// A wall at 0.8 m, and a finger that comes from the right side, its tip at a height over it.
Input finger_over_wall(double height) {
  Input in(ahead(160, 120));
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) {
      const size_t at = in.layers.index(x, y);
      in.view[at] = in.depth[at] = 0.8;
      paint(in.layers, at, kSkin);  // the wall has the color of skin, too
      in.reflectance.data[at] = {x < 80 ? -0.5 : -1.5, -1, -2, 1};
      if (x < 60 || y < 55 || y > 62) continue;
      // Rises by half of its way; 16 mm thick.
      in.depth[at] = 0.8 - height - 0.016 - 0.5 * (x - 60) * 0.8 / in.camera.fx;
    }
  return in;
}

TEST_F(TouchTest, AgreesWithReferenceOnRandomInput) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const auto& [width, height] : {std::pair(1, 1), {9, 8}, {37, 5}, {160, 120}, {131, 67}})
    for (int kind = 0; kind < 3; ++kind) {
      Input in(ahead(width, height));
      for (size_t i = 0; i < in.depth.size(); ++i) {
        const double wall = 0.6 + (0.002 + 0.3 * kind) * unit(random);
        in.view[i] = unit(random) < 0.1 ? 0 : wall;
        // Patches in front, by any small distance.
        const bool patch = std::sin(0.15 * double(i % size_t(width))) > 0.2;
        in.depth[i] = unit(random) < 0.1 ? 0 : wall - (patch ? 0.1 * unit(random) : 0);
        for (size_t c = 0; c < 3; ++c) {
          in.layers.data[i][c] = double{kSkin[c]} * (0.5 + unit(random));
          in.reflectance.data[i][c] = -3 * unit(random);
        }
        in.reflectance.data[i][3] = unit(random) < 0.2 ? 0 : unit(random);
        Vec3 normal{unit(random) - 0.5, unit(random) - 0.5, -unit(random)};
        const double length = std::hypot(normal[0], normal[1], normal[2]);
        for (size_t c = 0; c < 3; ++c) in.normals.data[i][c] = normal[c] / length;
      }
      compare(in, find(in));
    }
}

TEST_F(TouchTest, BearsExtremeInput) {
  const double kInfinite = std::numeric_limits<double>::infinity(), kNone = std::nan("");
  for (const double odd : {kInfinite, -kInfinite, kNone, 1e30, -1.0, 1e-30}) {
    Input in = finger_over_wall(0);
    for (size_t i = 0; i < in.depth.size(); i += 7) {
      in.depth[i] = odd;
      in.view[(i + 3) % in.view.size()] = odd;
      in.layers.data[i] = {odd, odd, odd, odd};
      in.normals.data[i] = {odd, odd, odd, odd};
    }
    const Output out = find(in);
    for (const float value : out.result) EXPECT_TRUE(std::isfinite(value)) << odd;
    if (const auto touch = TouchFinder::read(out.result.data())) {
      for (size_t c = 0; c < 3; ++c) EXPECT_LT(std::abs(touch->place[c]), 3);
    }
  }
  const Input empty(ahead(40, 30));
  const Output none = find(empty);
  EXPECT_FALSE(TouchFinder::read(none.result.data()));
  EXPECT_EQ(TouchFinder::front(none.result.data()), 0);
}

TEST_F(TouchTest, FindsAFingerOnAWall) {
  const Input in = finger_over_wall(0);
  const Output out = find(in);
  compare(in, out);
  const auto touch = TouchFinder::read(out.result.data());
  ASSERT_TRUE(touch);
  const Vec3 ray = in.camera.ray(62, 58.5),
             tip = in.camera.to_world({0.8 * ray[0], 0.8 * ray[1], 0.8});
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(double{touch->place[c]}, tip[c], 0.02) << c;
  ASSERT_TRUE(touch->color);
  EXPECT_NEAR(double{(*touch->color)[0]}, std::exp(-0.5), 0.01) << "of the wall";
  // The wall around it is kept.
  EXPECT_EQ(out.kept[in.layers.index(30, 58)], 0.8F);
  EXPECT_EQ(out.kept[in.layers.index(100, 58)], 0);
}

TEST_F(TouchTest, HoveringSkinAndOtherColorsAreNoTouch) {
  for (const double height : {0.03, 0.05, 0.2}) {
    const Input in = finger_over_wall(height);
    const Output out = find(in);
    compare(in, out);
    EXPECT_FALSE(TouchFinder::read(out.result.data())) << height;
    EXPECT_GT(TouchFinder::front(out.result.data()), 0.03F);
  }
  Input glove = finger_over_wall(0);
  for (size_t i = 0; i < glove.depth.size(); ++i) paint(glove.layers, i, kCloth);
  EXPECT_FALSE(TouchFinder::read(find(glove).result.data()));
  const Input still = finger_over_wall(0);
  EXPECT_TRUE(TouchFinder::read(find(still).result.data()));
  const Output lost = find(finger_over_wall(0), false);
  EXPECT_FALSE(TouchFinder::read(lost.result.data())) << "the camera is lost";
  EXPECT_EQ(TouchFinder::front(lost.result.data()), 0);
}

/// A table of the color of skin, of which only the part left of the picture's middle was seen
/// before, with the floor behind it.
TEST_F(TouchTest, WhatContinuesTheSceneIsNoTouch) {
  Input in(ahead(160, 120));
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) {
      const size_t at = in.layers.index(x, y);
      in.depth[at] = 0.8;
      in.view[at] = x < 80 ? 0.8 : 1.2;
      paint(in.layers, at, kSkin);
      in.reflectance.data[at] = {-1, -1, -2, 1};
    }
  const Output out = find(in);
  compare(in, out);
  EXPECT_FALSE(TouchFinder::read(out.result.data()));
  EXPECT_GT(TouchFinder::front(out.result.data()), 0.4F);
}

}  // namespace
}  // namespace inverse::testing
