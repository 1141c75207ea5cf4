// SPDX-License-Identifier: LGPL-2.1-or-later
// stroke-scenes FOLDER STAMP: renders stand-ins, with truth, for the pictures on which the thesis
// shows strokes: a color chart under uneven light (Fig. 4.4), creases in cloth of one paint (4.3),
// and a shirt with a logo (4.5). Writes STAMP when done. Deterministic.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string_view>

#include "rendered.hpp"
#include "tools/clip/glyphs.hpp"

namespace inverse::bench {
namespace {

using clip::Shape;
using clip::Vec3;

constexpr int kWidth = 320, kHeight = 240;
constexpr clip::Quality kStill{36, 16, 3};

const clip::Frame kFacing = clip::rotation({1, 0, 0}, clip::kPi / 2);

/// A gray wall and a floor, a near lamp to the left, a weak window to the right.
clip::Scene room() {
  clip::Scene scene;
  scene.primitives = {
      {Shape::kRectangle, {3, 0, 2}, {0, 0.8F, -0.58F}, kFacing, plain({0.5F, 0.49F, 0.47F})},
      {Shape::kRectangle, {3, 0, 3}, {0, 0, 1}, {}, plain({0.42F, 0.36F, 0.31F})}};
  scene.lamp = {{-0.75F, 0.85F, 0.25F}, 0.015F, 0.6F};
  scene.window = {{1.9F, 0.2F, 0.1F}, {0, 0, 1.3F}, {0, 1.3F, 0}, 0.3F};
  scene.camera = {{0, 0.45F, 1.3F}, {0, 0.4F, -0.58F}, 0.5F};
  return scene;
}

TruthFrame chart() {
  // The 24 patches of a ColorChecker.
  constexpr unsigned kPatches[4][6] = {
      {0x735244, 0xc29682, 0x627a9d, 0x576c43, 0x8580b1, 0x67bdaa},
      {0xd67e2c, 0x505ba6, 0xc15a63, 0x5e3c6c, 0x9dbc40, 0xe0a32e},
      {0x383d96, 0x469449, 0xaf363c, 0xe7c71f, 0xbb5695, 0x0885a1},
      {0xf3f3f2, 0xc8c8c8, 0xa0a0a0, 0x7a7a79, 0x555555, 0x343434}};
  constexpr float kPitch = 0.17F, kSize = 0.073F, kWall = -0.58F;
  clip::Scene scene = room();
  const auto sheet = [&](Vec3 size, Vec3 place, Vec3 color) {
    scene.primitives.push_back({Shape::kRectangle, size, place, kFacing, plain(color)});
  };
  sheet({3 * kPitch, 0, 2 * kPitch}, {0, 0.42F, kWall + 0.0004F}, {0.03F, 0.03F, 0.03F});
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 6; ++column)
      sheet(
          {kSize, 0, kSize},
          {(float(column) - 2.5F) * kPitch, 0.42F + (1.5F - float(row)) * kPitch, kWall + 0.0008F},
          clip::srgb(kPatches[row][column]));
  return rendered(scene, kWidth, kHeight, kStill);
}

/// A curtain: round folds of several widths, with deep creases between them.
TruthFrame cloth() {
  constexpr float kWidths[] = {0.05F, 0.035F, 0.06F, 0.03F, 0.045F, 0.055F};
  const clip::Paint paint = plain(clip::srgb(0xa04848));
  clip::Scene scene = room();
  scene.primitives.push_back(
      {Shape::kRectangle, {0.43F, 0, 0.5F}, {0, 0.42F, -0.545F}, kFacing, paint});
  float x = -0.42F;
  for (int k = 0; x < 0.42F; ++k) {
    const float radius = kWidths[k % 6];
    scene.primitives.push_back({Shape::kFrustum,
                                {radius, 0.5F, 0.8F * radius},
                                {x + radius, 0.42F, -0.52F - 0.02F * float(k % 3)},
                                clip::rotation({0, 0, 1}, 0.03F * float(k % 5 - 2)),
                                paint});
    x += 1.7F * radius;
  }
  return rendered(scene, kWidth, kHeight, kStill);
}

constexpr Vec3 kShirt{0.55F, 0.56F, 0.6F};

/// The color of the shirt where there is no ink; `u`, `v` in heights of the logo from its center.
Vec3 logo(float u, float v) {
  constexpr std::string_view kText = "LIGHT";
  const float radius = std::hypot(u, v);
  const float dot = 0.024F, left = -0.5F * dot * float(clip::kGlyphAdvance) * float(kText.size());
  if (clip::inked(kText, int(std::floor((u - left) / dot)),
                  int(std::floor(v / dot + 0.5F * clip::kGlyphHeight))))
    return {0.85F, 0.83F, 0.8F};
  if (radius > 0.5F) return kShirt;
  if (radius > 0.42F) return {0.07F, 0.07F, 0.08F};
  return std::abs(v) < 0.13F ? Vec3{0.1F, 0.1F, 0.11F} : Vec3{0.2F, 0.21F, 0.24F};
}

/// A person's shirt, with folds. The logo is painted into the picture: light that it would reflect
/// to other surfaces is missing from their shading.
TruthFrame shirt() {
  const clip::Paint paint = plain(kShirt), skin = plain({0.68F, 0.46F, 0.36F});
  clip::Scene scene = room();
  scene.primitives.push_back(
      {Shape::kEllipsoid, {0.36F, 0.46F, 0.16F}, {0, 0.28F, -0.2F}, {}, paint});
  scene.primitives.push_back(
      {Shape::kFrustum, {0.08F, 0.09F, 0.065F}, {0, 0.78F, -0.2F}, {}, skin});
  constexpr float kFolds[][3] = {// place and turn
                                 {-0.2F, 0.2F, 0.5F},   {0.17F, 0.18F, -0.6F},
                                 {-0.17F, 0.53F, 2.4F}, {0.2F, 0.47F, 0.8F},
                                 {0.02F, 0.12F, 0.3F},  {-0.25F, 0.38F, -0.3F}};
  for (const auto& [x, y, turn] : kFolds) {
    const float across = x / 0.36F, up = (y - 0.28F) / 0.46F;
    const float surface = -0.2F + 0.16F * std::sqrt(1 - across * across - up * up);
    scene.primitives.push_back({Shape::kEllipsoid,
                                {0.03F, 0.12F, 0.025F},
                                {x, y, surface - 0.008F},
                                clip::rotation({0, 0, 1}, turn),
                                paint});
  }
  TruthFrame frame = rendered(scene, kWidth, kHeight, kStill);
  constexpr int kSamples = 4;  // of a pixel, along x and y
  constexpr float kCenterX = 160, kCenterY = 118, kLogo = 76;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      Vec3 sum{};
      for (int i = 0, row = 0; i < kSamples * kSamples; ++i, row = i / kSamples)
        sum = sum + logo((float(x) + (float(i % kSamples) + 0.5F) / kSamples - kCenterX) / kLogo,
                         (float(y) + (float(row) + 0.5F) / kSamples - kCenterY) / kLogo);
      for (int c = 0; c < 3; ++c) {
        const float share = sum[c] / float(kSamples * kSamples) / kShirt[c];
        frame.reflectance.at(x, y, c) *= share;
        frame.input.at(x, y, c) =
            frame.reflectance.at(x, y, c) * (frame.direct.at(x, y, c) + frame.indirect.at(x, y, c));
      }
    }
  frame.input = through_8_bits(frame.input);
  return frame;
}

void write_all(const std::string& folder) {
  write_scene(folder, {"strokes", "chart", "diverse value", false, {chart()}});
  write_scene(folder, {"strokes", "cloth", "little paint", false, {cloth()}});
  write_scene(folder, {"strokes", "shirt", "diverse value", false, {shirt()}});
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fprintf(stderr, "usage: stroke-scenes FOLDER STAMP\n");
    return 2;
  }
  inverse::bench::write_all(argv[1]);
  std::ofstream(argv[2]) << argv[1] << '\n';
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "stroke-scenes: %s\n", error.what());
  return 1;
}
