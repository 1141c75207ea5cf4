// SPDX-License-Identifier: LGPL-2.1-or-later
// Analytic and signed-distance primitives, each posed by a rotation and a translation.
#pragma once

#include <optional>

#include "paint.hpp"
#include "vec.hpp"

namespace inverse::clip {

enum class Shape {
  kEllipsoid,   ///< semi-axes `size`
  kBox,         ///< half extents `size`
  kRectangle,   ///< y = 0, half extents size.x and size.z, seen from both sides
  kFrustum,     ///< axis y, half height size.y, radius size.x at the bottom and size.z at the top
  kTorus,       ///< ring in the xz plane, ring radius size.x, tube radius size.y
  kRoundedBox,  ///< half extents `size`, edge radius kEdgeRadius
  kVase,        ///< solid of revolution about y (profile in shapes.cpp), scaled by size.x
};

constexpr float kEdgeRadius = 0.006f;

/// One thing in the scene. Hit positions handed to `paint` are local and in meters.
struct Primitive {
  Shape shape = Shape::kBox;
  Vec3 size;
  Vec3 position;
  Frame frame;
  Paint paint;
};

struct Ray {
  Vec3 origin, direction;  ///< direction is a unit vector
};

struct LocalHit {
  float distance;
  Vec3 normal;  ///< outward, local
};

struct Bounds {
  Vec3 low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};
};

/// Nearest intersection of a ray in the primitive's own frame with distance in (0, limit).
std::optional<LocalHit> intersect(const Primitive& primitive, const Ray& local, float limit);

/// World-space box around the primitive.
Bounds bounds(const Primitive& primitive);

}  // namespace inverse::clip
