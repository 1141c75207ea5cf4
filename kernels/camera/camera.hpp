// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <span>

#include "kernels/image/plane.hpp"

namespace inverse {

/// A pinhole camera without distortion: focal lengths and center in pixels, pixel centers at whole
/// numbers, x right, y down, z forward.
struct Lens {
  float fx = 0, fy = 0, cx = 0, cy = 0;
  std::array<float, 4> values() const { return {fx, fy, cx, cy}; }
};

/// Where a camera is: the unit quaternion (x, y, z, w) that turns its directions into the world's,
/// and its place in meters. On the device it is two vec4.
struct Pose {
  std::array<float, 4> rotation{0, 0, 0, 1};
  std::array<float, 4> place{0, 0, 0, 0};  ///< w is 0
};

/// The pose whose matrix, that takes points of the camera to the world, has these first three rows;
/// the nearest one if its left part is not quite a rotation.
Pose pose_of_rows(std::span<const double, 12> rows);
/// A point of the camera in the world, and back; meters.
std::array<float, 3> to_world(const Pose& pose, const std::array<float, 3>& point);
std::array<float, 3> to_camera(const Pose& pose, const std::array<float, 3>& point);
/// A camera that turns with another one, from `before` to `after`; its place stays.
Pose turned_along(const Pose& camera, const Pose& before, const Pose& after);
/// Where a point of the camera, in front of it, is seen: pixels, whose centers are at whole
/// numbers.
std::array<float, 2> projected(const Lens& lens, const std::array<float, 3>& point);
/// Whether a ball, in the camera's axes, may be in sight of a camera of `size` that sees as far as
/// max_depth; meters.
bool in_sight(const Lens& lens, Extent size, float max_depth, const std::array<float, 3>& center,
              float radius);
/// These rows of a pose.
std::array<double, 12> rows_of(const Pose& pose);

}  // namespace inverse
