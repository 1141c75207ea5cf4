// SPDX-License-Identifier: LGPL-2.1-or-later
// Rotations of meshes. Axes: x right, y up, z towards the camera; degrees.
#pragma once
#include <cmath>
#include <numbers>

#include "rasterizer.hpp"

namespace inverse {

using Turn = std::array<MeshView::Row, 3>;  ///< rows
constexpr float kRadian = std::numbers::pi_v<float> / 180;

/// Rotation about x, towards the camera for positive angles.
inline Turn nod(float degrees) {
  const float c = std::cos(degrees * kRadian), s = std::sin(degrees * kRadian);
  return {{{1, 0, 0}, {0, c, -s}, {0, s, c}}};
}
inline Turn about_y(float degrees) {
  const float c = std::cos(degrees * kRadian), s = std::sin(degrees * kRadian);
  return {{{c, 0, s}, {0, 1, 0}, {-s, 0, c}}};
}
inline Turn about_z(float degrees) {
  const float c = std::cos(degrees * kRadian), s = std::sin(degrees * kRadian);
  return {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}};
}

inline Turn operator*(const Turn& a, const Turn& b) {
  Turn product{};
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j)
      for (size_t k = 0; k < 3; ++k) product[i][j] += a[i][k] * b[k][j];
  return product;
}

}  // namespace inverse
