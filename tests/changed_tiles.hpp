// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "tests/lab.hpp"

namespace inverse {

/// Tiles of 16 x 16 pixels, row by row, 1 if frames differ in a bit.
inline std::vector<uint8_t> changed_tiles(Extent extent, const Pixels& a, const Pixels& b) {
  const size_t columns = (extent.width + 15) / 16, rows = (extent.height + 15) / 16;
  std::vector<uint8_t> changed(columns * rows);
  for (size_t i = 0; i < extent.pixels(); ++i)
    if (memcmp(&a[4 * i], &b[4 * i], 16) != 0)
      changed[i / extent.width / 16 * columns + i % extent.width / 16] = 1;
  return changed;
}

}  // namespace inverse
