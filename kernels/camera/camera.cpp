// SPDX-License-Identifier: LGPL-2.1-or-later
#include "camera.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace inverse {
namespace {

using Rows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

Eigen::Quaternionf rotation_of(const Pose& pose) {
  const auto& [x, y, z, w] = pose.rotation;
  return {w, x, y, z};
}
Eigen::Vector3f place_of(const Pose& pose) {
  return Eigen::Map<const Eigen::Vector3f>(pose.place.data());
}

}  // namespace

std::array<float, 3> to_world(const Pose& pose, const std::array<float, 3>& point) {
  const Eigen::Vector3f p =
      rotation_of(pose) * Eigen::Map<const Eigen::Vector3f>(point.data()) + place_of(pose);
  return {p.x(), p.y(), p.z()};
}

std::array<float, 3> to_camera(const Pose& pose, const std::array<float, 3>& point) {
  const Eigen::Vector3f p = rotation_of(pose).conjugate() *
                            (Eigen::Map<const Eigen::Vector3f>(point.data()) - place_of(pose));
  return {p.x(), p.y(), p.z()};
}

Pose turned_along(const Pose& camera, const Pose& before, const Pose& after) {
  const Eigen::Quaternionf turn =
      rotation_of(after) * rotation_of(before).conjugate() * rotation_of(camera);
  return {{turn.x(), turn.y(), turn.z(), turn.w()}, camera.place};
}

Pose pose_of_rows(std::span<const double, 12> rows) {
  const Eigen::Map<const Rows> matrix(rows.data());
  const Eigen::Matrix3d left = matrix.leftCols<3>();
  const Eigen::Quaterniond turn = Eigen::Quaterniond(left).normalized();
  Pose pose;
  for (Eigen::Index c = 0; c < 4; ++c)
    pose.rotation[static_cast<size_t>(c)] = static_cast<float>(turn.coeffs()[c]);
  for (Eigen::Index c = 0; c < 3; ++c)
    pose.place[static_cast<size_t>(c)] = static_cast<float>(matrix(c, 3));
  return pose;
}

std::array<float, 2> projected(const Lens& lens, const std::array<float, 3>& point) {
  return {lens.fx * point[0] / point[2] + lens.cx, lens.fy * point[1] / point[2] + lens.cy};
}

bool in_sight(const Lens& lens, Extent size, float max_depth, const std::array<float, 3>& center,
              float radius) {
  const float z = center[2];
  if (z < -radius || z > max_depth + radius) return false;
  const auto beyond = [&](float f, float c, uint32_t pixels, float at) {
    const float low = (-0.5F - c) / f, high = (static_cast<float>(pixels) - 0.5F - c) / f;
    return std::max((low * z - at) / std::sqrt(1 + low * low),
                    (at - high * z) / std::sqrt(1 + high * high));
  };
  return std::max(beyond(lens.fx, lens.cx, size.width, center[0]),
                  beyond(lens.fy, lens.cy, size.height, center[1])) < radius;
}

std::array<double, 12> rows_of(const Pose& pose) {
  std::array<double, 12> rows;
  Eigen::Map<Rows> matrix(rows.data());
  matrix.leftCols<3>() = rotation_of(pose).cast<double>().toRotationMatrix();
  for (Eigen::Index c = 0; c < 3; ++c)
    matrix(c, 3) = static_cast<double>(pose.place[static_cast<size_t>(c)]);
  return rows;
}

}  // namespace inverse
