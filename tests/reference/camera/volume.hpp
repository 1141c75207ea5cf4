// SPDX-License-Identifier: LGPL-2.1-or-later
// Specification of kernels/depth: distances and reflectance of a scene in a sparse grid.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "tests/reference/plane.hpp"

namespace inverse::reference {

using Cell = std::array<int, 3>;

/// x right, y down, z forward; pixel centers at whole numbers.
struct Camera {
  double fx, fy, cx, cy;
  int width, height;
  std::array<double, 4> rotation{0, 0, 0, 1};  ///< to the world: unit quaternion, x y z w
  Vec3 place{};                                ///< meters
  Vec3 ray(double x, double y) const { return {(x - cx) / fx, (y - cy) / fy, 1}; }
  Vec3 turned(const Vec3& v) const;
  Vec3 to_world(const Vec3& v) const;
  Vec3 to_camera(const Vec3& v) const;
};

struct Voxel {
  double distance = 0;  ///< truncations
  double weight = 0;
  Vec3 color{};  ///< ln reflectance
  double sure = 0;
};

struct Volume {
  double voxel, truncation;  ///< meters
  double max_depth, memory;
  std::map<Cell, std::vector<Voxel>> blocks;  ///< of 512 voxels, x first

  /// The blocks that a frame makes: those at places at most half a block apart along the rays of
  /// every second pixel, from one truncation before the surface to one behind it.
  void allocate(const Camera& camera, const Plane& surface);
  /// `surface`: normal and depth; `layers`: reflectance.
  void integrate(const Camera& camera, const Plane& surface, const Plane& layers);
  /// Null where no block is.
  const Voxel* at(const Cell& voxel) const;
  /// Trilinear over the voxels that were seen; false if they are less than a third.
  bool distance_at(const Vec3& place, double& distance) const;
  /// Depth of the first zero along the ray of a pixel between `from` and `to`, found in steps of a
  /// tenth of a voxel; 0 if there is none.
  double march(const Camera& camera, int x, int y, double from, double to) const;
};

/// What two means of a voxel are together.
Voxel merged(const Voxel& a, const Voxel& b);

/// Whether a camera is turned by more than `max_turn` radians from another one, or more than
/// `max_shift` meters away.
bool elsewhere(const Camera& a, const Camera& b, double max_turn, double max_shift);

/// Unit normals toward the camera of a depth image; 0 where there is none.
Plane normals(const Camera& camera, const std::vector<double>& depth);

}  // namespace inverse::reference
