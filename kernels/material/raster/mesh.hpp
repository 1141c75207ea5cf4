// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace inverse {

/// Triangles with a normal at every corner, in camera axes: x right, y up, z towards the camera.
struct Mesh {
  using Vec3 = std::array<float, 3>;
  static constexpr size_t kMaxTriangles = 1000000;

  std::vector<Vec3> positions, normals;  ///< of the same length
  std::vector<uint32_t> indices;         ///< three per triangle

  size_t triangles() const { return indices.size() / 3; }

  /// Prepares the mesh for drawing. Drops triangles without area or with invalid or non-finite
  /// corners. Corners without a normal (absent, zero, not finite) get the area-weighted mean of
  /// their triangles' normals. Centers the bounding box at the origin and scales the farthest
  /// corner to distance 1. Sorts triangles by position. Throws Error(file) if no triangle remains
  /// or there are more than kMaxTriangles; messages call the mesh `name`.
  void prepare(const char* name);

  /// A sphere of radius 1, prepared.
  static Mesh sphere();
};

}  // namespace inverse
