// SPDX-License-Identifier: LGPL-2.1-or-later
// Change information that the elements pass to a method with each frame of a video.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/bench/metrics/image.hpp"

namespace inverse::bench {

/// Tiles of 16 x 16 pixels, row by row, 1 if two frames of one size differ, as the elements compare
/// bytes.
inline std::vector<std::uint8_t> changed_tiles(const Image& before, const Image& frame) {
  constexpr int kTile = 16;
  const int columns = (frame.width + kTile - 1) / kTile, rows = (frame.height + kTile - 1) / kTile;
  std::vector<std::uint8_t> changed(std::size_t(columns) * std::size_t(rows));
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x)
      for (int c = 0; c < frame.channels; ++c)
        if (frame.at(x, y, c) != before.at(x, y, c))
          changed[std::size_t(y / kTile) * std::size_t(columns) + std::size_t(x / kTile)] = 1;
  return changed;
}

}  // namespace inverse::bench
