// SPDX-License-Identifier: LGPL-2.1-or-later
// edit-scenes FOLDER STAMP: renders pairs of frames for edits with the renderer of the bundled
// clip: a scene, and the same with repainted surfaces, including all bounces of light. Writes STAMP
// when done. Deterministic.
#include <cstdio>
#include <exception>
#include <fstream>

#include "rendered.hpp"

namespace inverse::bench {
namespace {

using clip::Primitive;
using clip::Shape;
using clip::Vec3;

constexpr int kWidth = 320, kHeight = 240;

/// A room with an open front: floor, back wall, side walls; a lamp above, a weak window in front.
clip::Scene room(Vec3 floor, Vec3 back, Vec3 left, Vec3 right) {
  const clip::Frame facing = clip::rotation({1, 0, 0}, clip::kPi / 2),
                    upright = clip::rotation({0, 0, 1}, clip::kPi / 2);
  clip::Scene scene;
  scene.primitives = {
      {Shape::kRectangle, {0.75F, 0, 0.75F}, {0, 0, 0.1F}, {}, plain(floor)},
      {Shape::kRectangle, {0.75F, 0, 0.8F}, {0, 0.8F, -0.6F}, facing, plain(back)},
      {Shape::kRectangle, {0.8F, 0, 0.75F}, {-0.7F, 0.8F, 0.1F}, upright, plain(left)},
      {Shape::kRectangle, {0.8F, 0, 0.75F}, {0.7F, 0.8F, 0.1F}, upright, plain(right)}};
  scene.lamp = {{0.1F, 0.93F, 0.25F}, 0.02F, 0.55F};
  scene.window = {{-0.4F, 0.2F, 1.9F}, {0.8F, 0, 0}, {0, 0.8F, 0}, 0.12F};
  scene.camera = {{0, 0.5F, 1.9F}, {0, 0.36F, -0.1F}, 0.62F};
  return scene;
}

void furnish(clip::Scene& scene) {
  scene.primitives.push_back({Shape::kBox,
                              {0.14F, 0.28F, 0.12F},
                              {-0.28F, 0.28F, -0.2F},
                              clip::rotation({0, 1, 0}, 0.35F),
                              plain({0.72F, 0.71F, 0.68F})});
  scene.primitives.push_back({Shape::kBox,
                              {0.12F, 0.12F, 0.12F},
                              {0.3F, 0.12F, 0.15F},
                              clip::rotation({0, 1, 0}, -0.4F),
                              plain({0.75F, 0.6F, 0.12F})});
  scene.primitives.push_back({Shape::kEllipsoid,
                              {0.1F, 0.1F, 0.1F},
                              {-0.05F, 0.1F, 0.25F},
                              {},
                              plain({0.5F, 0.5F, 0.5F})});
}

/// Head and shoulders, of boxes and balls.
void pose(clip::Scene& scene) {
  const clip::Paint skin = plain({0.68F, 0.46F, 0.36F}), shirt = plain({0.75F, 0.75F, 0.77F}),
                    hair = plain({0.09F, 0.06F, 0.05F});
  scene.primitives.push_back(
      {Shape::kEllipsoid, {0.13F, 0.17F, 0.14F}, {0, 0.56F, 0.1F}, {}, skin});
  scene.primitives.push_back(
      {Shape::kEllipsoid, {0.14F, 0.12F, 0.15F}, {0, 0.65F, 0.06F}, {}, hair});
  scene.primitives.push_back({Shape::kFrustum, {0.07F, 0.08F, 0.06F}, {0, 0.36F, 0.08F}, {}, skin});
  scene.primitives.push_back(
      {Shape::kEllipsoid, {0.34F, 0.2F, 0.17F}, {0, 0.17F, 0.06F}, {}, shirt});
}

/// A frame and the same after the edit; `id` is 1 if paint changed.
Scene pair(const char* name, const char* regime, const clip::Scene& before,
           const clip::Scene& after) {
  constexpr clip::Quality kStill{36, 25, 4};
  Scene scene{"edits", name, regime, false, {}};
  for (const clip::Scene* one : {&before, &after})
    scene.frames.push_back(rendered(*one, kWidth, kHeight, kStill));
  Image changed(kWidth, kHeight, 1);
  for (std::size_t i = 0; i < changed.data.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      if (scene.frames[0].reflectance.data[3 * i + c] !=
          scene.frames[1].reflectance.data[3 * i + c])
        changed.data[i] = 1;
  for (TruthFrame& frame : scene.frames) frame.id = changed;
  return scene;
}

void write_all(const std::string& folder) {
  const Vec3 white{0.73F, 0.72F, 0.7F}, red{0.62F, 0.06F, 0.05F}, green{0.12F, 0.5F, 0.1F},
      blue{0.06F, 0.13F, 0.6F}, screen{0.09F, 0.55F, 0.14F}, gray{0.36F, 0.36F, 0.36F},
      orange{0.75F, 0.33F, 0.05F}, violet{0.4F, 0.1F, 0.55F};
  const auto furnished = [&](Vec3 floor, Vec3 left, Vec3 right) {
    clip::Scene scene = room(floor, white, left, right);
    furnish(scene);
    return scene;
  };
  const auto posed = [&](Vec3 floor, Vec3 back, Vec3 sides) {
    clip::Scene scene = room(floor, back, sides, sides);
    pose(scene);
    return scene;
  };
  write_scene(folder, pair("red wall, blue", "recolor", furnished(white, red, white),
                           furnished(white, blue, white)));
  write_scene(folder, pair("green wall of two, violet", "recolor", furnished(white, red, green),
                           furnished(white, red, violet)));
  write_scene(folder, pair("orange floor, green", "recolor", furnished(orange, white, white),
                           furnished(green, white, white)));
  write_scene(folder, pair("green screen, gray", "despill", posed(screen, screen, screen),
                           posed(gray, gray, gray)));
  write_scene(folder, pair("green floor and wall, gray", "despill", posed(screen, screen, gray),
                           posed(gray, gray, gray)));
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fprintf(stderr, "usage: edit-scenes FOLDER STAMP\n");
    return 2;
  }
  inverse::bench::write_all(argv[1]);
  std::ofstream(argv[2]) << argv[1] << '\n';
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "edit-scenes: %s\n", error.what());
  return 1;
}
