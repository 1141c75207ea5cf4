// SPDX-License-Identifier: LGPL-2.1-or-later
// Three-component vectors and right-handed frames for the clip renderer. Lengths are meters,
// colors linear Rec. 709; y points up and z toward the viewer.
#pragma once

#include <algorithm>
#include <cmath>

namespace inverse::clip {

constexpr float kPi = 3.14159265358979f;

struct Vec3 {
  float x = 0, y = 0, z = 0;
  float operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  Vec3& operator+=(Vec3 b) {
    x += b.x, y += b.y, z += b.z;
    return *this;
  }
};

inline Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
inline Vec3 operator*(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline Vec3 operator*(Vec3 a, float s) { return {a.x * s, a.y * s, a.z * s}; }
inline Vec3 operator*(float s, Vec3 a) { return a * s; }
inline Vec3 operator/(Vec3 a, float s) { return a * (1 / s); }

inline float dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float length(Vec3 a) { return std::sqrt(dot(a, a)); }
inline Vec3 normalize(Vec3 a) { return a / length(a); }
inline Vec3 mix(Vec3 a, Vec3 b, float t) { return a + (b - a) * t; }
inline Vec3 min(Vec3 a, Vec3 b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
inline Vec3 max(Vec3 a, Vec3 b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
inline Vec3 abs(Vec3 a) { return {std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)}; }

/// Rec. 709 luminance.
inline float luminance(Vec3 c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

/// Hermite step from 0 at `a` to 1 at `b`.
inline float smoothstep(float a, float b, float x) {
  float t = std::clamp((x - a) / (b - a), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

/// A rotation, as the images of the three axes.
struct Frame {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  Vec3 to_world(Vec3 v) const { return x * v.x + y * v.y + z * v.z; }
  Vec3 to_local(Vec3 v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
};

/// A frame whose y axis is the unit vector `axis`.
inline Frame frame_along_y(Vec3 axis) {
  Vec3 helper = std::fabs(axis.x) > 0.7f ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
  Vec3 z = normalize(cross(helper, axis));
  return {cross(axis, z), axis, z};
}

/// Rotation by `angle` radians about the unit vector `axis` (Rodrigues).
inline Frame rotation(Vec3 axis, float angle) {
  float c = std::cos(angle), s = std::sin(angle);
  auto turn = [&](Vec3 v) { return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1 - c)); };
  return {turn({1, 0, 0}), turn({0, 1, 0}), turn({0, 0, 1})};
}

/// The rotation `outer` after `inner`.
inline Frame compose(const Frame& outer, const Frame& inner) {
  return {outer.to_world(inner.x), outer.to_world(inner.y), outer.to_world(inner.z)};
}

}  // namespace inverse::clip
