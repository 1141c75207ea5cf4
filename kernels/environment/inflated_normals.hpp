// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace inverse {

/// A unit normal in camera axes: x right, y up, z to the camera. z = 0: none.
using Normal = std::array<float, 3>;

/// Part of a grid of points: columns left…right − 1, rows top…bottom − 1.
struct GridWindow {
  uint32_t left = 0, top = 0, right = 0, bottom = 0;
};

/// Normals of an object from its outline alone, by inflation: ∇²u = −4 inside, u = 0 at the
/// outline, height √u. Exact for a sphere. An ellipse with half axes a and b becomes an ellipsoid
/// with third half axis √(2 a²b² / (a² + b²)); a long cylinder is √2 times too deep. Concavities,
/// edges and flat faces are not recovered.
/// `mask` has one byte per point, row by row, `side` x `side`, not 0 on the object. Points outside
/// of `window` are unknown: the surface continues there. Returns one normal per point, none outside
/// of the mask.
std::vector<Normal> inflated_normals(std::span<const uint8_t> mask, uint32_t side,
                                     const GridWindow& window);

}  // namespace inverse
