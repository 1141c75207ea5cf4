// SPDX-License-Identifier: LGPL-2.1-or-later
// own-scenes FOLDER STAMP: renders the project's own data for the benchmark with the renderer of
// the bundled clip: four kinds of stills, and videos that differ in the work they need. Writes
// STAMP when done. Takes about a minute of processor time; deterministic.
//
// own-scenes FOLDER --size WIDTHxHEIGHT: the stills alone, in this size.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <random>
#include <string>

#include "rendered.hpp"

namespace inverse::bench {
namespace {

using clip::Paint;
using clip::Pattern;
using clip::Primitive;
using clip::Shape;
using clip::Vec3;

constexpr int kWidth = 320, kHeight = 240;
constexpr const char* kSet = "own";

constexpr clip::Quality kStill{36, 16, 3}, kMoving{16, 4, 3};

TruthFrame render(const clip::Scene& scene, clip::Quality quality) {
  return rendered(scene, kWidth, kHeight, quality);
}

/// A floor and a wall, a near lamp to the left, a weak window to the right.
clip::Scene stage(Vec3 wall, Paint floor) {
  const clip::Frame facing = clip::rotation({1, 0, 0}, clip::kPi / 2);
  clip::Scene scene;
  scene.primitives = {{Shape::kRectangle, {3, 0, 2}, {0, 0.8F, -0.58F}, facing, plain(wall)},
                      {Shape::kRectangle, {3, 0, 3}, {0, 0, 1}, {}, floor}};
  scene.lamp = {{-0.95F, 0.95F, 0.75F}, 0.015F, 1.05F};
  scene.window = {{1.9F, 0.2F, 0.1F}, {0, 0, 1.3F}, {0, 1.3F, 0}, 0.3F};
  scene.camera = {{0.05F, 0.52F, 1.6F}, {0, 0.25F, -0.1F}, 0.62F};
  return scene;
}

/// Gray, navy and brown patches: equal chroma does not mean equal reflectance.
clip::Scene patches() {
  std::mt19937 random(11);
  const auto uniform = [&](float low, float high) {
    return low + (high - low) * float(random() % 10007) / 10006;
  };
  const auto color = [&] {
    static constexpr float kHues[][3] = {
        {1, 1, 1}, {1, 1, 1}, {0.45F, 0.55F, 1}, {1, 0.66F, 0.42F}, {1, 0.93F, 0.8F}};
    const float* hue = kHues[random() % 5];
    const float value = 0.04F * std::pow(20.0F, uniform(0, 1));
    return Vec3{value * hue[0], value * hue[1], value * hue[2]};
  };
  const Paint checker{Pattern::kChecker,
                      {{0.05F, 0.05F, 0.055F}, {0.32F, 0.32F, 0.31F}, {0.7F, 0.7F, 0.68F}},
                      0.14F,
                      ""};
  clip::Scene scene = stage({0.5F, 0.49F, 0.47F}, checker);
  const clip::Frame facing = clip::rotation({1, 0, 0}, clip::kPi / 2);
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 7; ++column)
      scene.primitives.push_back(
          {Shape::kRectangle,
           {uniform(0.05F, 0.085F), 0, uniform(0.045F, 0.07F)},
           {-0.62F + 0.2F * float(column), 0.14F + 0.165F * float(row), -0.57F},
           facing,
           plain(color())});
  scene.primitives.push_back({Shape::kBox,
                              {0.1F, 0.17F, 0.08F},
                              {-0.3F, 0.17F, 0},
                              clip::rotation({0, 1, 0}, 0.5F),
                              plain({0.05F, 0.06F, 0.12F})});
  scene.primitives.push_back(
      {Shape::kEllipsoid, {0.11F, 0.11F, 0.11F}, {0.06F, 0.11F, 0.15F}, {}, plain(color())});
  scene.primitives.push_back({Shape::kBox,
                              {0.09F, 0.09F, 0.09F},
                              {0.36F, 0.09F, 0.05F},
                              clip::rotation({0, 1, 0}, -0.4F),
                              {Pattern::kStickers, {}, 0.18F, ""}});
  return scene;
}

/// Bright colors of one value under hard shadows.
clip::Scene toys() {
  clip::Scene scene = stage({0.82F, 0.74F, 0.58F}, plain({0.55F, 0.8F, 0.6F}));
  const Vec3 colors[] = {{0.82F, 0.12F, 0.1F}, {0.1F, 0.3F, 0.8F},   {0.8F, 0.7F, 0.08F},
                         {0.1F, 0.8F, 0.25F},  {0.8F, 0.35F, 0.08F}, {0.6F, 0.1F, 0.8F}};
  const float places[][2] = {{-0.5F, -0.2F}, {-0.25F, 0.15F}, {0.0F, -0.15F},
                             {0.2F, 0.2F},   {0.42F, -0.1F},  {-0.42F, 0.4F}};
  for (int k = 0; k < 6; ++k) {
    const float size = 0.07F + 0.012F * float(k % 3);
    const Vec3 at{places[k][0], size, places[k][1]};
    const clip::Frame turned = clip::rotation({0, 1, 0}, 0.4F * float(k));
    if (k % 2)
      scene.primitives.push_back({Shape::kBox, {size, size, size}, at, turned, plain(colors[k])});
    else
      scene.primitives.push_back({Shape::kEllipsoid, {size, size, size}, at, {}, plain(colors[k])});
  }
  scene.primitives.push_back({Shape::kFrustum,
                              {0.03F, 0.3F, 0.03F},
                              {-0.42F, 0.3F, 0.1F},
                              {},
                              plain({0.8F, 0.78F, 0.75F})});
  return scene;
}

/// Clay: many shapes with hardly any paint, so that nearly all variation is shading.
clip::Scene sculptures() {
  clip::Scene scene = stage({0.6F, 0.57F, 0.52F}, plain({0.42F, 0.36F, 0.31F}));
  const Paint clay = plain({0.63F, 0.42F, 0.31F}), plaster = plain({0.74F, 0.72F, 0.68F}),
              slate = plain({0.21F, 0.23F, 0.26F});
  const clip::Frame upright = clip::rotation({1, 0, 0}, 1.2F);
  scene.primitives.push_back({Shape::kVase, {0.42F, 0, 0}, {-0.3F, 0, 0.05F}, {}, plaster});
  scene.primitives.push_back(
      {Shape::kTorus, {0.13F, 0.05F, 0}, {0.02F, 0.17F, -0.1F}, upright, clay});
  scene.primitives.push_back({Shape::kRoundedBox,
                              {0.09F, 0.09F, 0.09F},
                              {0.3F, 0.09F, 0.08F},
                              clip::rotation({0, 1, 0}, 0.7F),
                              slate});
  scene.primitives.push_back(
      {Shape::kEllipsoid, {0.08F, 0.08F, 0.08F}, {0.3F, 0.26F, 0.08F}, {}, plaster});
  scene.primitives.push_back(
      {Shape::kFrustum, {0.09F, 0.2F, 0.02F}, {0.52F, 0.2F, -0.2F}, {}, clay});
  scene.primitives.push_back(
      {Shape::kEllipsoid, {0.06F, 0.06F, 0.06F}, {0.05F, 0.06F, 0.25F}, {}, clay});
  return scene;
}

TruthFrame crop(const TruthFrame& frame, int x0, int y0, int width, int height) {
  const auto cut = [&](const Image& in) {
    Image out(width, height, in.channels);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        for (int c = 0; c < in.channels; ++c) out.at(x, y, c) = in.at(x0 + x, y0 + y, c);
    return out;
  };
  return {cut(frame.input),
          cut(frame.reflectance),
          cut(frame.shading),
          {},
          cut(frame.direct),
          cut(frame.indirect),
          {}};
}

/// A ball of one color, lit from the upper left, in front of a frame, whose direct and indirect
/// light is then unknown.
TruthFrame with_ball(TruthFrame frame, float center_x, float center_y) {
  constexpr float kRadius = 15;
  constexpr float kColor[] = {0.7F, 0.25F, 0.15F};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const float u = (float(x) - center_x) / kRadius, v = (float(y) - center_y) / kRadius;
      if (u * u + v * v >= 1) continue;
      const float light =
          std::max(0.0F, -0.5F * u - 0.6F * v + 0.62F * std::sqrt(1 - u * u - v * v));
      frame.shading.at(x, y) = 0.15F + 0.7F * light;
      for (int c = 0; c < 3; ++c) {
        frame.reflectance.at(x, y, c) = kColor[c];
        frame.input.at(x, y, c) = kColor[c] * frame.shading.at(x, y);
      }
    }
  frame.input = through_8_bits(frame.input);
  frame.direct = frame.indirect = {};
  return frame;
}

TruthFrame noisy(TruthFrame frame, unsigned seed) {
  std::mt19937 random(seed);
  frame.input = through_8_bits(with_noise(frame.input, random));
  return frame;
}

/// Writes the stills; returns the still life.
TruthFrame write_stills(const std::string& folder, int width, int height) {
  const auto write = [&](const char* name, const char* regime, const clip::Scene& scene) {
    TruthFrame frame = rendered(scene, width, height, kStill);
    write_scene(folder, {kSet, name, regime, false, {frame}});
    return frame;
  };
  write("patches", "diverse value", patches());
  write("sculptures", "little paint", sculptures());
  write("toys", "near-constant value", toys());
  return write("still life", "much of everything", clip::still_life(0.35F));
}

void write_all(const std::string& folder) {
  constexpr int kFrames = 10;
  const TruthFrame table = write_stills(folder, kWidth, kHeight);
  Scene light{kSet, "moving light", "everything changes", true, {}};
  Scene still{kSet, "still camera", "nothing changes", true, {}};
  Scene noise{kSet, "noisy camera", "sensor noise only", true, {}};
  Scene ball{kSet, "small ball", "a small object moves", true, {}};
  Scene pan{kSet, "panning camera", "everything moves", true, {}};
  for (int k = 0; k < kFrames; ++k) {
    light.frames.push_back(render(clip::still_life(0.3F + 0.04F * float(k)), kMoving));
    still.frames.push_back(table);
    noise.frames.push_back(noisy(table, unsigned(k)));
    ball.frames.push_back(with_ball(table, 60 + 6 * float(k), 60 + 4 * float(k)));
    pan.frames.push_back(crop(table, 4 * k, 2 * k, 256, 192));
  }
  for (const Scene* scene : {&light, &still, &noise, &ball, &pan}) write_scene(folder, *scene);
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) try {
  int width = 0, height = 0;
  if (argc == 4 && std::string(argv[2]) == "--size" &&
      std::sscanf(argv[3], "%dx%d", &width, &height) == 2 && width > 0 && height > 0) {
    inverse::bench::write_stills(argv[1], width, height);
    return 0;
  }
  if (argc != 3) {
    std::fprintf(stderr,
                 "usage: own-scenes FOLDER STAMP\n"
                 "       own-scenes FOLDER --size WIDTHxHEIGHT\n");
    return 2;
  }
  inverse::bench::write_all(argv[1]);
  std::ofstream(argv[2]) << argv[1] << '\n';
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "own-scenes: %s\n", error.what());
  return 1;
}
