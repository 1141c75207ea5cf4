// SPDX-License-Identifier: LGPL-2.1-or-later
// Change information that the elements pass to a method with each frame of a video.
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace inverse {

/// Tiles of 16 x 16 pixels, row by row, 1 if two frames of `channels` numbers a pixel differ in a
/// bit.
inline std::vector<std::uint8_t> changed_tiles(std::size_t width, std::size_t channels,
                                               const std::vector<float>& a,
                                               const std::vector<float>& b) {
  const std::size_t height = a.size() / channels / width, columns = (width + 15) / 16;
  std::vector<std::uint8_t> changed(columns * ((height + 15) / 16));
  for (std::size_t i = 0; i < a.size(); ++i) {
    const std::size_t pixel = i / channels;
    if (std::bit_cast<std::uint32_t>(a[i]) != std::bit_cast<std::uint32_t>(b[i]))
      changed[pixel / width / 16 * columns + pixel % width / 16] = 1;
  }
  return changed;
}

}  // namespace inverse
