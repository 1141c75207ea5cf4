// SPDX-License-Identifier: LGPL-2.1-or-later
#include "room.hpp"

#include <algorithm>
#include <array>

#include "noise.hpp"

namespace inverse::lime {
namespace {

/// Faces of the room in the order −x, +x, −y (floor), +y (ceiling), −z, +z (behind the camera).
enum Face { kLeft, kRight, kFloor, kCeiling, kBack, kFront };

/// The room around the origin: distance of each face.
using Distances = std::array<float, 6>;

/// Where a ray from the origin ends: the face, and coordinates on it (horizontal first, where there
/// is one).
struct Hit {
  int face;
  float a, b;
};

Hit trace(const Distances& box, Vec d) {
  const std::array<float, 3> way{d.x, d.y, d.z};
  float best = 1e9f;
  int face = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int f = 2 * axis + (way[std::size_t(axis)] > 0);
    const float t = box[std::size_t(f)] / std::max(std::abs(way[std::size_t(axis)]), 1e-6f);
    if (t < best) best = t, face = f;
  }
  const Vec p = best * d;
  if (face <= kRight) return {face, p.z, p.y};
  if (face <= kCeiling) return {face, p.x, p.z};
  return {face, p.x, p.y};
}

/// A rectangle on a face, with bars across it where `bars` > 0.
struct Patch {
  int face;
  float a, b, half_a, half_b;
  Vec color;       ///< Reflectance-like for furniture, radiance for lights.
  float fade = 0;  ///< Light of a window: brighter toward its top.
  float bars = 0;  ///< Bars per unit length; 6 % of it are bar.

  bool covers(const Hit& hit) const {
    return hit.face == face && std::abs(hit.a - a) < half_a && std::abs(hit.b - b) < half_b;
  }
  bool is_bar(const Hit& hit) const {
    const float t = (hit.a - a) * bars;
    return bars > 0 && t - std::floor(t) < 0.08f;
  }
};

struct Lamp {
  Vec direction, color;
  float radius, soft;  // rad
};

Vec warm_or_cold(Random& random) {
  const float t = random.uniform(-1.f, 1.f);
  return {1 + 0.14f * t, 1 + 0.01f * random.normal(), 1 - 0.18f * t};
}

/// The reach of a face's coordinates.
std::array<float, 4> extent(const Distances& box, int face) {
  if (face <= kRight) return {-box[kBack], box[kFront], -box[kFloor], box[kCeiling]};
  if (face <= kCeiling) return {-box[kLeft], box[kRight], -box[kBack], box[kFront]};
  return {-box[kLeft], box[kRight], -box[kFloor], box[kCeiling]};
}

/// A light on a face; `frontal`: in the half of the room where z > 0.
Patch area_light(Random& random, const Distances& box, bool frontal) {
  static constexpr int kFrontalFaces[] = {kFront, kFront, kCeiling, kLeft, kRight};
  static constexpr int kFaces[] = {kFront, kCeiling, kLeft, kRight, kBack};
  const int face = (frontal ? kFrontalFaces : kFaces)[random.below(5)];
  auto [a0, a1, b0, b1] = extent(box, face);
  if (frontal && face <= kRight) a0 = 0.15f * a1;
  if (frontal && face == kCeiling) b0 = 0.15f * b1;
  Patch light{face, random.uniform(a0 + 0.1f * (a1 - a0), a1 - 0.1f * (a1 - a0)), 0, 0, 0, {}};
  if (face == kCeiling) {
    light.b = random.uniform(b0, b1);
    const bool strip = random.chance(0.4f);
    light.half_a = random.uniform(0.15f, 0.6f);
    light.half_b = strip ? random.uniform(0.06f, 0.12f) : random.uniform(0.15f, 0.5f);
    if (random.chance(0.5f)) std::swap(light.half_a, light.half_b);
    light.color = random.log_uniform(8, 45) * warm_or_cold(random);
  } else {
    light.b = random.uniform(-0.1f, 0.6f) * b1;
    light.half_a = random.uniform(0.2f, 0.9f);
    light.half_b = random.uniform(0.25f, 0.8f);
    light.color = random.log_uniform(4, 25) * warm_or_cold(random);
    light.fade = random.uniform(0.f, 0.6f);
    if (random.chance(0.5f)) light.bars = random.uniform(1.f, 4.f);
  }
  return light;
}

}  // namespace

Environment make_room(Random& random) {
  Distances box;
  for (const int face : {kLeft, kRight, kBack, kFront})
    box[std::size_t(face)] = random.uniform(1.2f, 4.5f);
  box[kFloor] = random.uniform(0.7f, 1.4f);
  box[kCeiling] = random.uniform(0.9f, 2.2f);
  const float base = random.uniform(0.2f, 0.8f);
  std::array<Vec, 6> walls;
  for (Vec& wall : walls) {
    const float level = base * random.uniform(0.5f, 1.15f);
    wall = level * Vec{1 + 0.12f * random.normal(), 1 + 0.08f * random.normal(),
                       1 + 0.12f * random.normal()};
  }
  walls[kCeiling] = base * random.uniform(0.9f, 1.2f) * Vec{1, 1, 1};
  walls[kFloor] = random.uniform(0.25f, 0.8f) * walls[kFloor];

  std::vector<Patch> furniture;
  for (int i = 6 + random.below(14); i > 0; --i) {
    static constexpr int kFaces[] = {kLeft, kRight, kBack, kFront, kFloor};
    const int face = kFaces[random.below(5)];
    const auto [a0, a1, b0, b1] = extent(box, face);
    Patch patch{face,
                random.uniform(a0, a1),
                random.uniform(b0, face == kFloor ? b1 : 0.7f * b1),
                random.uniform(0.1f, 0.8f),
                random.uniform(0.1f, 0.6f),
                {}};
    const auto channel = [&] { return 0.02f + 0.85f * std::pow(random.uniform(), 1.5f); };
    patch.color = base * Vec{channel(), channel(), channel()};
    furniture.push_back(patch);
  }

  std::vector<Patch> lights;
  std::vector<Lamp> lamps;
  const bool starts_with_lamp = random.chance(0.35f);
  const int count = 1 + random.below(4);
  for (int i = 0; i < count; ++i) {
    if (i == 0 ? starts_with_lamp : random.chance(0.4f)) {
      const float azimuth = i == 0 ? random.uniform(-1.4f, 1.4f) : random.uniform(-kPi, kPi);
      const float up = random.uniform(0.1f, 0.95f), out = std::sqrt(1 - up * up);
      lamps.push_back({{out * std::sin(azimuth), up, out * std::cos(azimuth)},
                       random.log_uniform(12, 80) * warm_or_cold(random),
                       random.uniform(0.05f, 0.2f),
                       random.uniform(0.01f, 0.06f)});
    } else {
      lights.push_back(area_light(random, box, i == 0));
      // Office ceilings repeat their panels.
      if (lights.back().face == kCeiling && random.chance(0.5f))
        for (int k = -1; k <= 1; k += 2) {
          Patch copy = lights.back();
          copy.a += float(k) * (2 * copy.half_a + random.uniform(0.4f, 1.f));
          lights.push_back(copy);
        }
    }
  }

  const Noise texture(random, 8, 4);
  const float contrast = random.uniform(0.1f, 0.7f);
  Environment map{Environment::kRows, {}};
  map.radiance.reserve(std::size_t(Environment::kRows * Environment::kColumns));
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns(); ++column) {
      const Vec d = texel_direction(row, column, map.rows, map.columns());
      const Hit hit = trace(box, d);
      Vec e = walls[std::size_t(hit.face)];
      for (const Patch& patch : furniture)
        if (patch.covers(hit)) e = patch.color;
      e = (1 - contrast + 2 * contrast * texture(2 * hit.a + 3 * float(hit.face), 2 * hit.b)) * e;
      e = (1 - 0.35f * std::max(-d.y, 0.f)) * e;
      for (const Patch& light : lights)
        if (light.covers(hit) && !light.is_bar(hit))
          e = (1 - light.fade + light.fade * (hit.b - light.b + light.half_b) / light.half_b) *
              light.color;
      for (const Lamp& lamp : lamps) {
        const float angle = std::acos(std::clamp(dot(d, lamp.direction), -1.f, 1.f));
        e += std::clamp((lamp.radius - angle) / lamp.soft + 0.5f, 0.f, 1.f) * lamp.color;
      }
      map.radiance.push_back(e);
    }
  return map;
}

}  // namespace inverse::lime
