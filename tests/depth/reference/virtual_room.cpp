// SPDX-License-Identifier: LGPL-2.1-or-later
#include "virtual_room.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {
namespace {

constexpr double kFar = 1e4, kLift = 1e-3, kReach = 0.9, kHandOpen = 0.7;
constexpr int kDirections = 64;

Vec3 minus(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vec3 moved(const Vec3& a, double t, const Vec3& b) {
  return {a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]};
}
Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vec3 unit(const Vec3& v) { return moved({}, 1 / std::sqrt(dot(v, v)), v); }
Vec3 turned(double angle, const Vec3& v) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * v[0] - s * v[2], v[1], s * v[0] + c * v[2]};
}

double meets(const RoomSolid& s, const Vec3& from, const Vec3& along) {
  const Vec3 o = turned(s.turn, minus(from, s.center)), d = turned(s.turn, along);
  if (s.kind == RoomSolid::Kind::ball) {
    const double a = dot(d, d), b = dot(o, d),
                 q = b * b - a * (dot(o, o) - s.half_size[0] * s.half_size[0]);
    const double t = q > 0 && b < 0 ? (-b - std::sqrt(q)) / a : 0;
    return t > 0 ? t : kFar;
  }
  double enters = -kFar, leaves = kFar;
  for (size_t c = 0; c < 3; ++c) {
    const double low = (-s.half_size[c] - o[c]) / d[c], high = (s.half_size[c] - o[c]) / d[c];
    enters = std::max(enters, std::min(low, high));
    leaves = std::min(leaves, std::max(low, high));
  }
  if (s.kind == RoomSolid::Kind::inside) return leaves;
  return enters < leaves && enters > 0 ? enters : kFar;
}

/// The vector from the line of a part to a point.
Vec3 off_line(const Room::Part& part, const Vec3& at) {
  const Vec3 line = minus(part.to, part.from), off = minus(at, part.from);
  return moved(off, -std::clamp(dot(off, line) / dot(line, line), 0.0, 1.0), line);
}

/// Where a ray enters a part: the first place within its radius, by steps and bisection.
double meets(const Room::Part& part, const Vec3& from, const Vec3& along, double reach) {
  const auto beyond = [&](double t) {
    const Vec3 off = off_line(part, moved(from, t, along));
    return std::sqrt(dot(off, off)) - part.radius;
  };
  const double size = std::sqrt(dot(along, along));
  double t = 0;
  // Distances are those of a convex body: a step of that length does not enter it.
  for (int n = 0; n < 10000 && t < reach; ++n) {
    const double free = beyond(t);
    if (free < 1e-9) return n == 0 ? kFar : t;
    t += free / size;
  }
  return kFar;
}

double mod2(double x) { return x - 2 * std::floor(x / 2); }
/// The hash of the shader, in its precision.
float chance(float x, float y) {
  const float value = std::sin(x * 12.9898F + y * 78.233F) * 43758.547F;
  return value - std::floor(value);
}

Vec3 painted(const RoomSolid& s, const Vec3& p, size_t axis) {
  double u = 0, v = 0;
  if (s.kind == RoomSolid::Kind::ball) {
    u = std::atan2(p[0], p[2]) * s.half_size[0] / s.side;
    v = std::asin(std::clamp(p[1] / s.half_size[0], -1.0, 1.0)) * s.half_size[0] / s.side;
  } else {
    u = p[axis == 0 ? 2 : 0] / s.side;
    v = p[axis == 1 ? 2 : 1] / s.side;
  }
  const double x = std::floor(u), y = std::floor(v);
  bool other = false;
  switch (s.paint) {
    case RoomSolid::Paint::plain:
      break;
    case RoomSolid::Paint::checker:
      other = mod2(x + y) > 0.5;
      break;
    case RoomSolid::Paint::stripes:
      other = mod2(x) > 0.5;
      break;
    case RoomSolid::Paint::rings:
      other = mod2(std::floor(std::hypot(u, v))) > 0.5;
      break;
    case RoomSolid::Paint::letters:
      other = std::abs(v - y - 0.5) < 0.25 &&
              std::abs(u - x - 0.5) < 0.2 + 0.3 * double{chance(float(x), float(y))} &&
              chance(float(x) + 7, float(y) + 7) > 0.2F;
      break;
  }
  return other ? s.other : s.color;
}

}  // namespace

bool Room::open(const Vec3& from, const Vec3& along, double reach) const {
  return std::all_of(solids.begin() + 1, solids.end(),
                     [&](const RoomSolid& o) { return meets(o, from, along) >= reach; });
}

double Room::lit(const Vec3& from, const Vec3& normal) const {
  double light = 0;
  for (const Lamp& lamp : lamps) {
    const Vec3 to = minus(lamp.place, from);
    const double square = dot(to, to), cosine = dot(to, normal) / std::sqrt(square);
    const bool past_hand =
        std::ranges::all_of(hand, [&](const Part& part) { return meets(part, from, to, 1) >= 1; });
    if (cosine > 0 && open(from, to, 1) && past_hand) light += lamp.power * cosine / square;
  }
  return light;
}

Room::Seen Room::look(const Vec3& from, const Vec3& along) const {
  Seen seen{kFar, 0, {}, 0, 0};
  for (size_t i = 0; i < solids.size(); ++i)
    if (const double t = meets(solids[i], from, along); t < seen.along) seen = {t, i, {}, 0, 0};
  for (size_t i = 0; i < hand.size(); ++i)
    if (const double t = meets(hand[i], from, along, seen.along); t < seen.along)
      seen = {t, solids.size() + i, {}, 0, 0};
  const Vec3 at = moved(from, seen.along, along);
  if (seen.solid >= solids.size()) {
    const Part& part = hand[seen.solid - solids.size()];
    const Vec3 normal = unit(off_line(part, at)), lifted = moved(at, kLift, normal);
    seen.reflectance = part.color;
    seen.openness = kHandOpen;
    seen.direct = lit(lifted, normal);
    return seen;
  }
  const RoomSolid& s = solids[seen.solid];
  const Vec3 p = turned(s.turn, minus(at, s.center));
  size_t axis = 0;
  for (size_t c = 1; c < 3; ++c)
    if (std::abs(p[c] / s.half_size[c]) > std::abs(p[axis] / s.half_size[axis])) axis = c;
  Vec3 in_axes{};
  in_axes[axis] = (p[axis] > 0) != (s.kind == RoomSolid::Kind::inside) ? 1 : -1;
  if (s.kind == RoomSolid::Kind::ball) in_axes = unit(p);
  const Vec3 normal = turned(-s.turn, in_axes), lifted = moved(at, kLift, normal);
  seen.reflectance = painted(s, p, axis);
  seen.direct = lit(lifted, normal);
  const Vec3 x = unit(cross(normal, std::abs(normal[1]) < 0.9 ? Vec3{0, 1, 0} : Vec3{1, 0, 0})),
             y = cross(normal, x);
  for (int n = 0; n < kDirections; ++n) {
    const double up = (n + 0.5) / kDirections, angle = 2.399963 * n, level = std::sqrt(1 - up);
    const Vec3 flat = moved(moved({}, level * std::cos(angle), x), level * std::sin(angle), y);
    seen.openness += open(lifted, moved(flat, std::sqrt(up), normal), kReach) / double(kDirections);
  }
  return seen;
}

}  // namespace inverse::reference
