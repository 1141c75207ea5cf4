// SPDX-License-Identifier: LGPL-2.1-or-later
#include "camera.hpp"

#include <Eigen/Geometry>

namespace inverse {
namespace {

using Rows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

}  // namespace

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
  const auto& [x, y, z, w] = pose.rotation;
  std::array<double, 12> rows;
  Eigen::Map<Rows> matrix(rows.data());
  matrix.leftCols<3>() = Eigen::Quaternionf(w, x, y, z).cast<double>().toRotationMatrix();
  for (Eigen::Index c = 0; c < 3; ++c)
    matrix(c, 3) = static_cast<double>(pose.place[static_cast<size_t>(c)]);
  return rows;
}

}  // namespace inverse
