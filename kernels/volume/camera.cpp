// SPDX-License-Identifier: LGPL-2.1-or-later
#include "camera.hpp"

#include <Eigen/Geometry>

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

std::array<double, 12> rows_of(const Pose& pose) {
  std::array<double, 12> rows;
  Eigen::Map<Rows> matrix(rows.data());
  matrix.leftCols<3>() = rotation_of(pose).cast<double>().toRotationMatrix();
  for (Eigen::Index c = 0; c < 3; ++c)
    matrix(c, 3) = static_cast<double>(pose.place[static_cast<size_t>(c)]);
  return rows;
}

}  // namespace inverse
