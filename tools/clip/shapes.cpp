// SPDX-License-Identifier: LGPL-2.1-or-later
#include "shapes.hpp"

#include <array>

namespace inverse::clip {
namespace {

constexpr float kNear = 1e-5f;

std::optional<LocalHit> hit_ellipsoid(Vec3 size, const Ray& ray, float limit) {
  Vec3 inverse{1 / size.x, 1 / size.y, 1 / size.z};
  Vec3 o = ray.origin * inverse, d = ray.direction * inverse;
  float a = dot(d, d), b = dot(o, d), c = dot(o, o) - 1;
  float discriminant = b * b - a * c;
  if (discriminant < 0) return {};
  float root = std::sqrt(discriminant);
  float t = (-b - root) / a;
  if (t < kNear) t = (-b + root) / a;
  if (t < kNear || t >= limit) return {};
  return LocalHit{t, normalize((o + d * t) * inverse)};
}

/// Entry and exit distances of the slab test; false if the box is missed.
bool slab(Vec3 size, const Ray& ray, float& enter, float& leave, int& axis) {
  enter = -1e30f, leave = 1e30f, axis = 0;
  for (int k = 0; k < 3; ++k) {
    float inverse = 1 / ray.direction[k];
    float near = (-std::copysign(size[k], ray.direction[k]) - ray.origin[k]) * inverse;
    float far = (std::copysign(size[k], ray.direction[k]) - ray.origin[k]) * inverse;
    if (near > enter) enter = near, axis = k;
    leave = std::min(leave, far);
  }
  return enter <= leave && leave > kNear;
}

std::optional<LocalHit> hit_box(Vec3 size, const Ray& ray, float limit) {
  float enter, leave;
  int axis;
  if (!slab(size, ray, enter, leave, axis) || enter < kNear || enter >= limit) return {};
  float sign = ray.direction[axis] > 0 ? -1.0f : 1.0f;
  return LocalHit{enter, Vec3{axis == 0 ? sign : 0, axis == 1 ? sign : 0, axis == 2 ? sign : 0}};
}

std::optional<LocalHit> hit_rectangle(Vec3 size, const Ray& ray, float limit) {
  float t = -ray.origin.y / ray.direction.y;
  if (!(t > kNear && t < limit)) return {};
  Vec3 p = ray.origin + ray.direction * t;
  if (std::fabs(p.x) > size.x || std::fabs(p.z) > size.z) return {};
  return LocalHit{t, Vec3{0, ray.origin.y > 0 ? 1.0f : -1.0f, 0}};
}

std::optional<LocalHit> hit_frustum(Vec3 size, const Ray& ray, float limit) {
  // Side: x² + z² = (m + k y)², with m the mean radius and k the taper.
  float m = (size.x + size.z) / 2, k = (size.z - size.x) / (2 * size.y);
  Vec3 o = ray.origin, d = ray.direction;
  float ro = m + k * o.y, rd = k * d.y;
  float a = d.x * d.x + d.z * d.z - rd * rd;
  float b = o.x * d.x + o.z * d.z - ro * rd;
  float c = o.x * o.x + o.z * o.z - ro * ro;
  std::optional<LocalHit> best;
  float discriminant = b * b - a * c;
  if (discriminant > 0 && std::fabs(a) > 1e-9f) {
    float root = std::sqrt(discriminant);
    for (float t : {(-b - root) / a, (-b + root) / a}) {
      Vec3 p = o + d * t;
      if (t > kNear && t < limit && std::fabs(p.y) <= size.y) {
        limit = t;
        best = LocalHit{t, normalize(Vec3{p.x, -k * (m + k * p.y), p.z})};
      }
    }
  }
  for (float side : {-1.0f, 1.0f}) {
    float t = (side * size.y - o.y) / d.y;
    float radius = side < 0 ? size.x : size.z;
    Vec3 p = o + d * t;
    if (t > kNear && t < limit && p.x * p.x + p.z * p.z <= radius * radius) {
      limit = t;
      best = LocalHit{t, Vec3{0, side, 0}};
    }
  }
  return best;
}

// Radius of the vase at equal steps of height, foot to lip, for unit height.
constexpr std::array kVaseRadius = {0.200f, 0.245f, 0.290f, 0.322f, 0.335f, 0.325f, 0.288f,
                                    0.228f, 0.165f, 0.125f, 0.110f, 0.122f, 0.175f};
constexpr float kVaseSteepness = 1.6f;  // bound on |dr/dy| below

/// The profile as a uniform cubic B-spline of the table.
float vase_radius(float y) {
  constexpr int kLast = static_cast<int>(kVaseRadius.size()) - 1;
  float s = std::clamp(y, 0.0f, 1.0f) * kLast;
  int i = std::min(static_cast<int>(s), kLast - 1);
  float t = s - static_cast<float>(i);
  auto at = [&](int k) { return kVaseRadius[static_cast<size_t>(std::clamp(k, 0, kLast))]; };
  float w0 = (1 - t) * (1 - t) * (1 - t), w3 = t * t * t;
  float w1 = 3 * w3 - 6 * t * t + 4, w2 = 6 - w0 - w1 - w3;
  return (w0 * at(i - 1) + w1 * at(i) + w2 * at(i + 1) + w3 * at(i + 2)) / 6;
}

/// Lower bound of the distance of (radius, height) to the vase, hollow at its mouth.
float vase_distance(float r, float y) {
  constexpr float kHollowBelow = 0.8f, kWall = 0.02f;
  float slant = 1 / std::sqrt(1 + kVaseSteepness * kVaseSteepness);
  float outside = std::max((r - vase_radius(y)) * slant, std::fabs(y - 0.5f) - 0.5f);
  float cavity = std::max((r - vase_radius(y) + kWall) * slant, kHollowBelow - y);
  return std::max(outside, -cavity);
}

float distance(const Primitive& primitive, Vec3 p) {
  Vec3 size = primitive.size;
  if (primitive.shape == Shape::kTorus) {
    float ring = std::sqrt(p.x * p.x + p.z * p.z) - size.x;
    return std::sqrt(ring * ring + p.y * p.y) - size.y;
  }
  if (primitive.shape == Shape::kRoundedBox) {
    Vec3 q = abs(p) - size + Vec3{kEdgeRadius, kEdgeRadius, kEdgeRadius};
    float inside = std::min(std::max(q.x, std::max(q.y, q.z)), 0.0f);
    return length(max(q, {})) + inside - kEdgeRadius;
  }
  float scale = size.x;
  return vase_distance(std::sqrt(p.x * p.x + p.z * p.z) / scale, p.y / scale) * scale;
}

Vec3 local_extent(const Primitive& primitive) {
  Vec3 size = primitive.size;
  switch (primitive.shape) {
    case Shape::kRectangle:
      return {size.x, 1e-4f, size.z};
    case Shape::kFrustum:
      return {std::max(size.x, size.z), size.y, std::max(size.x, size.z)};
    case Shape::kTorus:
      return {size.x + size.y, size.y, size.x + size.y};
    case Shape::kVase:
      return Vec3{0.34f, 1.0f, 0.34f} * size.x;
    default:
      return size;
  }
}

/// Sphere tracing inside the primitive's box.
std::optional<LocalHit> hit_distance_field(const Primitive& primitive, const Ray& ray,
                                           float limit) {
  constexpr float kTolerance = 2e-5f;
  constexpr int kSteps = 96;
  float enter, leave;
  int axis;
  if (!slab(local_extent(primitive) + Vec3{1e-4f, 1e-4f, 1e-4f}, ray, enter, leave, axis)) {
    return {};
  }
  float t = std::max(enter, kNear), end = std::min(leave, limit);
  for (int step = 0; step < kSteps && t < end; ++step) {
    float d = distance(primitive, ray.origin + ray.direction * t);
    if (d < kTolerance) {
      Vec3 p = ray.origin + ray.direction * t;
      constexpr float h = 2e-4f;
      auto slope = [&](Vec3 e) { return distance(primitive, p + e) - distance(primitive, p - e); };
      return LocalHit{t, normalize({slope({h, 0, 0}), slope({0, h, 0}), slope({0, 0, h})})};
    }
    t += d;
  }
  return {};
}

}  // namespace

std::optional<LocalHit> intersect(const Primitive& primitive, const Ray& local, float limit) {
  switch (primitive.shape) {
    case Shape::kEllipsoid:
      return hit_ellipsoid(primitive.size, local, limit);
    case Shape::kBox:
      return hit_box(primitive.size, local, limit);
    case Shape::kRectangle:
      return hit_rectangle(primitive.size, local, limit);
    case Shape::kFrustum:
      return hit_frustum(primitive.size, local, limit);
    default:
      return hit_distance_field(primitive, local, limit);
  }
}

Bounds bounds(const Primitive& primitive) {
  Vec3 e = local_extent(primitive);
  const Frame& f = primitive.frame;
  Vec3 reach = abs(f.x) * e.x + abs(f.y) * e.y + abs(f.z) * e.z + Vec3{1e-4f, 1e-4f, 1e-4f};
  return {primitive.position - reach, primitive.position + reach};
}

}  // namespace inverse::clip
