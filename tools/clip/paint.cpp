// SPDX-License-Identifier: LGPL-2.1-or-later
#include "paint.hpp"

#include <cstdint>
#include <initializer_list>
#include <string_view>

#include "glyphs.hpp"

namespace inverse::clip {
namespace {

uint32_t hash(int x, int y, int z) {
  uint32_t h = static_cast<uint32_t>(x) * 0x8da6b343u ^ static_cast<uint32_t>(y) * 0xd8163841u ^
               static_cast<uint32_t>(z) * 0xcb1ab31fu;
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  h = (h ^ (h >> 12)) * 0x297a2d39u;
  return h ^ (h >> 15);
}

float random(int x, int y, int z) { return static_cast<float>(hash(x, y, z) >> 8) * 0x1p-24f; }

/// Value noise in 0…1 with unit lattice.
float noise(Vec3 p) {
  float fx = std::floor(p.x), fy = std::floor(p.y), fz = std::floor(p.z);
  int x = static_cast<int>(fx), y = static_cast<int>(fy), z = static_cast<int>(fz);
  float u = smoothstep(0, 1, p.x - fx), v = smoothstep(0, 1, p.y - fy);
  float w = smoothstep(0, 1, p.z - fz);
  auto along_x = [&](int j, int k) {
    return std::lerp(random(x, y + j, z + k), random(x + 1, y + j, z + k), u);
  };
  return std::lerp(std::lerp(along_x(0, 0), along_x(1, 0), v),
                   std::lerp(along_x(0, 1), along_x(1, 1), v), w);
}

int cell(float x) { return static_cast<int>(std::floor(x)); }
int wrap(int i, int n) { return ((i % n) + n) % n; }

bool text_at(std::string_view text, float x, float y, float dot) {
  return inked(text, cell(x / dot), cell(y / dot));
}

Vec3 wood(const Paint& paint, Vec3 p) {
  int plank = cell(p.z / paint.period);
  float across = p.z / paint.period - static_cast<float>(plank);
  float shift = random(plank, 3, 7) * 2;
  int board = cell((p.x + shift) / 1.3f);
  float along = (p.x + shift) / 1.3f - static_cast<float>(board);
  if (across < 0.018f || along < 0.0016f) return paint.colors[1] * 0.25f;  // the joints
  Vec3 q{(p.x + 9.1f * random(plank, board, 1)) * 3, 0, p.z * 38};
  float warp = noise({q.x * 0.7f, 5, q.z * 0.12f}) * 5;
  float rings = 0.5f + 0.5f * std::sin(q.z * 0.9f + warp * 2.2f);
  float fibers = noise({q.x * 4, 1, q.z * 6});
  float t = 0.45f * rings + 0.35f * fibers + 0.35f * (random(plank, board, 2) - 0.3f);
  return mix(paint.colors[0], paint.colors[1], std::clamp(t, 0.0f, 1.0f));
}

Vec3 wallpaper(const Paint& paint, Vec3 p) {
  int stripe = cell(p.x / paint.period);
  float across = p.x / paint.period - static_cast<float>(stripe) - 0.5f;
  Vec3 ground = paint.colors[wrap(stripe, 2)];
  if (std::fabs(std::fabs(across) - 0.44f) < 0.022f) return paint.colors[2];
  if (wrap(stripe, 2) == 0) return ground;
  // A four-petaled flower every period and a half, on the darker stripes only.
  float height = p.z / (1.5f * paint.period) + 0.5f * static_cast<float>(wrap(stripe / 2, 2));
  float v = (height - std::floor(height) - 0.5f) * 1.5f, u = across;
  float radius = std::sqrt(u * u + v * v), angle = std::atan2(v, u);
  if (radius < 0.045f) return srgb(0xd9a441);
  return radius < 0.19f * std::fabs(std::cos(2 * angle)) + 0.02f ? paint.colors[2] : ground;
}

Vec3 poster(Vec3 p) {
  constexpr float kWidth = 0.42f, kHeight = 0.52f;
  const Vec3 paper = srgb(0xe6e1d3), ink = srgb(0x1b1b1f);
  float x = p.x + kWidth / 2, y = p.z + kHeight / 2;  // from the top left
  if (text_at("INTRINSIC", x - 0.048f, y - 0.04f, 0.0062f)) return ink;
  // Swatches of different hue and value, in three rows.
  constexpr int kColumns = 4;
  static const Vec3 swatches[] = {srgb(0xc8372d), srgb(0xe3a32b), srgb(0x3f8f4f), srgb(0x2b5fae),
                                  srgb(0x6a2c70), srgb(0x16303f), srgb(0x8fc1b5), srgb(0xd98c7a),
                                  srgb(0x222222), srgb(0x5a5a5a), srgb(0x8c8c8c), srgb(0xbdbdbd)};
  constexpr float kSwatch = 0.078f, kPitch = 0.0845f;
  float sx = x - 0.043f, sy = y - 0.115f;
  int column = cell(sx / kPitch), row = cell(sy / kPitch);
  if (column >= 0 && column < kColumns && row >= 0 && row < 3) {
    float u = sx - static_cast<float>(column) * kPitch, v = sy - static_cast<float>(row) * kPitch;
    if (u < kSwatch && v < kSwatch) return swatches[row * kColumns + column];
  }
  float line = y - 0.39f;
  for (const char* text : {"REFLECTANCE", "TIMES SHADING", "IS THE IMAGE"}) {
    if (text_at(text, x - 0.045f, line, 0.0040f)) return ink;
    line -= 0.038f;
  }
  return paper;
}

Vec3 book(const Paint& paint, Vec3 p, Vec3 normal) {
  if (std::fabs(normal.y) > 0.5f) return paint.colors[0];
  if (normal.z < 0.5f) {
    return std::fabs(p.y) < paint.period / 2 - 0.004f ? paint.colors[1] : paint.colors[0];
  }
  float dot = paint.period / 13;
  float width = static_cast<float>(std::string_view(paint.title).size()) * kGlyphAdvance * dot;
  if (text_at(paint.title, p.x + width / 2, 3.5f * dot - p.y, dot)) return paint.colors[2];
  if (std::fabs(std::fabs(p.x) - width / 2 - 0.02f) < 0.003f) return paint.colors[2];
  return paint.colors[0];
}

Vec3 stickers(const Paint& paint, Vec3 p, Vec3 n) {
  static const Vec3 palette[] = {srgb(0xc41e2f), srgb(0xe8dfd0), srgb(0x1f56a8),
                                 srgb(0xe8b51d), srgb(0x2f9148), srgb(0xdd6a1c)};
  Vec3 a = abs(n);
  int axis = a.x > a.y ? (a.x > a.z ? 0 : 2) : (a.y > a.z ? 1 : 2);
  float u = (p[(axis + 1) % 3] / paint.period + 0.5f) * 3;
  float v = (p[(axis + 2) % 3] / paint.period + 0.5f) * 3;
  int i = cell(u), j = cell(v);
  float du = std::fabs(u - static_cast<float>(i) - 0.5f);
  float dv = std::fabs(v - static_cast<float>(j) - 0.5f);
  if (std::max(du, dv) > 0.43f || a[axis] < 0.98f) return srgb(0x1c1c1c);
  return palette[hash(i, j, axis * 2 + (n[axis] > 0)) % 6];
}

Vec3 segments(Vec3 p) {
  static const Vec3 palette[] = {srgb(0xd02f36), srgb(0xefe8da), srgb(0x1e6fb8),
                                 srgb(0xefe8da), srgb(0xf0b323), srgb(0xefe8da)};
  if (std::fabs(p.y) > 0.95f * length(p)) return srgb(0xefe8da);
  float turn = std::atan2(p.z, p.x) / (2 * kPi) + 0.5f;
  return palette[std::min(cell(turn * 6), 5)];
}

Vec3 leaf(const Paint& paint, Vec3 p) {
  float across = std::fabs(p.z) / paint.period, along = p.x / paint.period;
  if (across < 0.03f * (1.2f - along)) return paint.colors[1];
  float vein = std::fabs(wrap(cell((along + across * 1.2f) * 12), 2) - 0.5f) + across;
  return mix(paint.colors[0], paint.colors[1], 0.18f * std::fabs(std::sin(vein * 9)));
}

Vec3 speckles(const Paint& paint, Vec3 p) {
  Vec3 q = p / paint.period;
  float grain = noise(q);
  if (grain > 0.74f) return paint.colors[1];
  return grain < 0.24f ? paint.colors[2] : paint.colors[0];
}

}  // namespace

Vec3 srgb(unsigned code) {
  auto linear = [](unsigned byte) {
    float v = static_cast<float>(byte & 255u) / 255;
    return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
  };
  return {linear(code >> 16), linear(code >> 8), linear(code)};
}

Vec3 reflectance(const Paint& paint, Vec3 p, Vec3 normal) {
  switch (paint.pattern) {
    case Pattern::kChecker:
      return paint.colors[wrap(cell(p.x / paint.period) + 2 * cell(p.z / paint.period), 3)];
    case Pattern::kStripes:
      return paint.colors[wrap(cell(p.y / paint.period), 2)];
    case Pattern::kSegments:
      return segments(p);
    case Pattern::kWood:
      return wood(paint, p);
    case Pattern::kWallpaper:
      return wallpaper(paint, p);
    case Pattern::kPoster:
      return poster(p);
    case Pattern::kBook:
      return book(paint, p, normal);
    case Pattern::kStickers:
      return stickers(paint, p, normal);
    case Pattern::kLeaf:
      return leaf(paint, p);
    case Pattern::kSpeckles:
      return speckles(paint, p);
    case Pattern::kPlain:
      break;
  }
  return paint.colors[0];
}

}  // namespace inverse::clip
