// SPDX-License-Identifier: LGPL-2.1-or-later
// Four images in one, in double precision. The specification of kernels/image/view/mosaic.
#pragma once

#include <array>

#include "tests/reference/plane.hpp"

namespace inverse::reference {

struct Tile {
  const Plane* picture = nullptr;  ///< null: black
  bool scalar = false;             ///< w as gray instead of rgb
  double gain = 1;
};

/// Tiles at half size in reading order, the left and the top ones larger where the size is odd. A
/// pixel is the mean of the 2×2 under it (at an odd border the last row or column counts twice)
/// times `gain`; w = 1. All pictures have this size.
Plane mosaic(const std::array<Tile, 4>& tiles, int width, int height);

}  // namespace inverse::reference
