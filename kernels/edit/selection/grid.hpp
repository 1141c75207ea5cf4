// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <algorithm>
#include <cstdint>

#include "kernels/image/plane.hpp"

namespace inverse {

/// The grid of cells on which objects are selected: squares of `side` pixels, a power of two, so
/// that no side of the frame has more than 320. Those at the right and lower border may be smaller.
struct CellGrid {
  explicit CellGrid(Extent frame) : frame(frame) {
    while (std::max(frame.width, frame.height) > 320 * side) side *= 2;
    cells = {(frame.width + side - 1) / side, (frame.height + side - 1) / side};
  }
  Extent frame, cells;
  uint32_t side = 1;
};

}  // namespace inverse
