// SPDX-License-Identifier: LGPL-2.1-or-later
#include "shapes.hpp"

#include <algorithm>
#include <numeric>

namespace inverse::lime {
namespace {

/// The surface |p| = 1 pushed to where `position` says, over directions.
template <typename Position>
Grid sphere_grid(Position position) {
  return make_grid(80, 160, false, [&](float u, float v) {
    const float theta = kPi * u, phi = 2 * kPi * v;
    return position(
        Vec{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)});
  });
}

/// Barr's superquadric along rays from its center, tapered and twisted.
Grid superquadric(Random& random, float exponent) {
  const float around = random.uniform(0.15f, 2.f);
  const Vec axes{random.uniform(0.5f, 1.f), random.uniform(0.5f, 1.f), random.uniform(0.5f, 1.f)};
  const float taper = random.chance(0.3f) ? random.uniform(-0.5f, 0.5f) : 0.f;
  const float twist = random.chance(0.25f) ? random.uniform(-1.2f, 1.2f) : 0.f;
  return sphere_grid([&](Vec d) {
    const float x = std::abs(d.x) / axes.x, y = std::abs(d.y) / axes.y, z = std::abs(d.z) / axes.z;
    const float ring =
        std::pow(std::pow(x, 2 / around) + std::pow(y, 2 / around), around / exponent);
    const Vec p = std::pow(ring + std::pow(z, 2 / exponent), -exponent / 2) * d;
    const float wide = 1 + taper * p.z, c = std::cos(twist * p.z), s = std::sin(twist * p.z);
    return Vec{wide * (c * p.x - s * p.y), wide * (s * p.x + c * p.y), p.z};
  });
}

/// Legendre polynomial P_l(x).
float legendre(int l, float x) {
  float before = 1, now = x;
  for (int k = 1; k < l; ++k) {
    const float next = (float(2 * k + 1) * x * now - float(k) * before) / float(k + 1);
    before = now;
    now = next;
  }
  return now;
}

/// 1 + a spherical harmonic of one degree (a sum of zonal ones about random axes, which span them)
/// + one of degree 2.
Grid blob(Random& random, int degree) {
  struct Lobe {
    Vec axis;
    float size;
    int degree;
  };
  std::vector<Lobe> lobes;
  const float size = random.uniform(0.08f, 0.25f);
  for (int i = 0; i < 7; ++i) {
    const Vec axis = normalize({random.normal(), random.normal(), random.normal()});
    lobes.push_back({axis, size * random.normal(), i < 5 ? degree : 2});
  }
  return sphere_grid([&](Vec d) {
    float r = 1;
    for (const Lobe& lobe : lobes) r += lobe.size * legendre(lobe.degree, dot(d, lobe.axis));
    return std::max(r, 0.3f) * d;
  });
}

struct ProfilePoint {
  float radius, height;
};

/// A point of the curve through `points`, smooth (Catmull-Rom) or straight, t in [0, 1].
ProfilePoint on_curve(const std::vector<ProfilePoint>& points, bool smooth, float t) {
  const int last = int(points.size()) - 1;
  const int i = std::min(int(t * float(last)), last - 1);
  const float f = t * float(last) - float(i);
  const auto at = [&](int k) { return points[std::size_t(std::clamp(k, 0, last))]; };
  const auto mix = [&](float a, float b, float c, float d) {
    if (!smooth) return b + f * (c - b);
    return 0.5f * (2 * b + (c - a) * f + (2 * a - 5 * b + 4 * c - d) * f * f +
                   (3 * b - a - 3 * c + d) * f * f * f);
  };
  const ProfilePoint a = at(i - 1), b = at(i), c = at(i + 1), d = at(i + 2);
  return {std::max(mix(a.radius, b.radius, c.radius, d.radius), 0.01f),
          mix(a.height, b.height, c.height, d.height)};
}

/// A surface of revolution about z: flat or pointed ends, solid or hollow with a rim, plain or
/// fluted.
Grid lathe(Random& random, int points) {
  std::vector<ProfilePoint> wall;
  const float height = random.uniform(0.4f, 1.3f);
  for (int i = 0; i < points; ++i) {
    const float radius = random.uniform(0.15f, 1.f);
    wall.push_back({radius, height * (2 * float(i) / float(points - 1) - 1) +
                                0.1f * random.normal() / float(points)});
  }
  const bool smooth = random.chance(0.7f), hollow = random.chance(0.35f);
  if (random.chance(0.4f)) wall.front().radius = 0.03f;
  if (!hollow && random.chance(0.4f)) wall.back().radius = 0.03f;

  std::vector<ProfilePoint> profile;
  // Close to edges the samples lie dense, so that normals are averaged over narrow bevels there.
  constexpr float kCap[] = {0.f, 0.25f, 0.5f, 0.75f, 0.9f, 0.97f};
  const auto cap = [&](ProfilePoint edge, bool outward) {
    for (int i = 0; i < 6; ++i)
      profile.push_back({edge.radius * (outward ? kCap[i] : kCap[5 - i]), edge.height});
  };
  constexpr int kWall = 64, kInner = 40;
  cap(on_curve(wall, smooth, 0), true);
  for (int i = 0; i <= kWall; ++i) profile.push_back(on_curve(wall, smooth, float(i) / kWall));
  if (hollow) {
    const float thick = random.uniform(0.04f, 0.12f), depth = random.uniform(0.4f, 0.95f);
    for (int i = 0; i <= kInner; ++i) {
      ProfilePoint p = on_curve(wall, smooth, 1 - depth * float(i) / kInner);
      profile.push_back({std::max(p.radius - thick, 0.02f), p.height});
    }
  }
  cap(profile.back(), false);

  const float flute = random.chance(0.25f) ? random.uniform(0.02f, 0.12f) : 0.f;
  const int flutes = 3 + random.below(12);
  const bool square = random.chance(0.3f);
  const int rows = int(profile.size());
  return make_grid(rows, 144, false, [&](float u, float v) {
    const ProfilePoint p = profile[std::size_t(std::lround(u * float(rows - 1)))];
    const float phi = 2 * kPi * v;
    float wave = std::cos(float(flutes) * phi);
    if (square) wave = std::clamp(3 * wave, -1.f, 1.f);
    const float radius = p.radius * (1 + flute * wave);
    return Vec{radius * std::cos(phi), radius * std::sin(phi), p.height};
  });
}

/// A tube around a torus knot: `turns` around the ring while it goes 1 to 3 times along it; no
/// turns: a torus.
Grid tube(Random& random, int turns) {
  int along = 1;
  if (turns > 0 && random.chance(0.5f)) along = 2 + random.below(2);
  if (std::gcd(along, turns) != 1) along = 1;
  const float out = turns ? random.uniform(0.15f, 0.4f) : 0.f,
              up = turns ? random.uniform(0.15f, 0.5f) : 0.f;
  const float thick = turns == 0   ? random.uniform(0.15f, 0.55f)
                      : along == 1 ? random.uniform(0.12f, 0.35f)
                                   : random.uniform(0.1f, 0.22f);
  const float flat = random.uniform(0.65f, 1.5f);
  const float swell = random.chance(0.4f) ? random.uniform(0.f, 0.3f) : 0.f;
  const int swells = 1 + random.below(6);
  const auto curve = [&](float t) {
    const float ring = 1 + out * std::cos(float(turns) * t);
    return Vec{ring * std::cos(float(along) * t), ring * std::sin(float(along) * t),
               up * std::sin(float(turns) * t)};
  };
  return make_grid(along == 1 ? 160 : 220, 32, true, [&](float u, float v) {
    const float t = 2 * kPi * u, a = 2 * kPi * v;
    const Vec center = curve(t), tangent = normalize(curve(t + 0.01f) - curve(t - 0.01f));
    // A frame that closes by itself: from the ring's radial direction, which is nowhere along the
    // curve.
    const Vec radial{std::cos(float(along) * t), std::sin(float(along) * t), 0};
    const Vec side = normalize(cross(tangent, radial)), front = cross(side, tangent);
    const float r = thick * (1 + swell * std::cos(float(swells) * t));
    return center + r * std::cos(a) * front + r * flat * std::sin(a) * side;
  });
}

/// Moves vertices along their normals by a sum of waves of about `frequency` radians per unit.
void displace(Random& random, float frequency, Grid& grid) {
  struct Wave {
    Vec k;
    float phase, size;
  };
  std::vector<Wave> waves;
  const float size = random.uniform(0.06f, 0.3f) / frequency;
  for (int i = 0; i < 8; ++i) {
    const Vec way = normalize({random.normal(), random.normal(), random.normal()});
    const float f = frequency * random.uniform(0.8f, 1.7f);
    waves.push_back({f * way, random.uniform(0.f, 2 * kPi), size});
  }
  for (std::size_t i = 0; i < grid.positions.size(); ++i) {
    float sum = 0;
    for (const Wave& w : waves) sum += w.size * std::sin(dot(w.k, grid.positions[i]) + w.phase);
    grid.positions[i] += sum * grid.normals[i];
  }
  finish(grid);
}

float draw_trait(Random& random, Family family, bool held_out) {
  static constexpr int kDegrees[] = {2, 3, 5, 6, 7}, kPoints[] = {4, 5, 7, 8, 9},
                       kTurns[] = {0, 0, 2, 3, 5, 6};
  const auto range = [&](float low, float high, float from, float to) {
    if (held_out) return random.uniform(from, to);
    const float x = random.uniform(low, high - (to - from));
    return x < from ? x : x + (to - from);
  };
  switch (family) {
    case Family::superquadric:
      return range(0.15f, 2.f, 0.5f, 0.75f);
    case Family::blob:
      return held_out ? 4.f : float(kDegrees[random.below(5)]);
    case Family::lathe:
      return held_out ? 6.f : float(kPoints[random.below(5)]);
    case Family::tube:
      return held_out ? 4.f : float(kTurns[random.below(6)]);
    case Family::displaced:
      return range(2.5f, 9.f, 4.5f, 6.f);
  }
  return 0;
}

struct Part {
  Grid grid;
  Family family;
  float trait;
};

Part make_part(Random& random, bool held_out, int families) {
  const auto family = Family(random.below(families));
  const float trait = draw_trait(random, family, held_out);
  switch (family) {
    case Family::superquadric:
      return {superquadric(random, trait), family, trait};
    case Family::blob:
      return {blob(random, int(trait)), family, trait};
    case Family::lathe:
      return {lathe(random, int(trait)), family, trait};
    case Family::tube:
      return {tube(random, int(trait)), family, trait};
    case Family::displaced:
      break;
  }
  Part part = make_part(random, held_out, kFamilies - 1);
  displace(random, trait, part.grid);
  return {std::move(part.grid), family, trait};
}

/// Moves and scales a grid: x → center + scale·turn(x).
void place(Grid& grid, const Rotation& turn, float scale, Vec center) {
  for (Vec& p : grid.positions) p = center + scale * turn(p);
  for (Vec& n : grid.normals) n = turn(n);
}

}  // namespace

bool is_held_out(Family family, float trait) {
  switch (family) {
    case Family::superquadric:
      return trait >= 0.5f && trait < 0.75f;
    case Family::blob:
      return trait == 4;
    case Family::lathe:
      return trait == 6;
    case Family::tube:
      return trait == 4;
    case Family::displaced:
      return trait >= 4.5f && trait < 6;
  }
  return false;
}

Object make_object(Random& random, bool held_out) {
  Part first = make_part(random, held_out, kFamilies);
  Object object{{}, first.family, first.trait, first.family == Family::lathe};
  object.parts.push_back(std::move(first.grid));
  const int more = random.chance(0.3f) ? 1 + random.below(2) : 0;
  for (int i = 0; i < more; ++i) {
    Part part = make_part(random, held_out, kFamilies);
    const auto& on = object.parts[0].positions;
    const Vec center = random.uniform(0.6f, 1.f) * on[std::size_t(random.below(int(on.size())))];
    const Rotation turn = rotation_of(random.quaternion());
    place(part.grid, turn, random.uniform(0.25f, 0.65f), center);
    object.parts.push_back(std::move(part.grid));
  }
  Vec low{1e9f, 1e9f, 1e9f}, high{-1e9f, -1e9f, -1e9f};
  for (const Grid& part : object.parts)
    for (const Vec p : part.positions) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  const Vec center = 0.5f * (low + high);
  float radius = 0;
  for (const Grid& part : object.parts)
    for (const Vec p : part.positions) radius = std::max(radius, length(p - center));
  for (Grid& part : object.parts) place(part, Rotation{}, 1 / radius, (-1 / radius) * center);
  return object;
}

}  // namespace inverse::lime
