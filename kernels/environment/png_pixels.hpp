// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "kernels/image/plane.hpp"

namespace inverse {

/// A PNG of at most 8192 x 8192 pixels: RGBA codes of 16 bits, row by row. Those of 8 bits are
/// times 257; gray is repeated; alpha is 65535 if the file has none.
struct PngPixels {
  Extent extent;
  int channels = 0;         ///< of the file, 1…4; 1 and 2: gray
  bool is_16_bits = false;  ///< else codes were of 8 bits
  std::vector<uint16_t> codes;

  bool gray() const { return channels < 3; }
};

/// Reads a PNG from strangers. Throws Error(file): the path, why, and `expected`, which says what
/// the file should be.
PngPixels read_png_pixels(const std::string& path, const std::string& expected);

}  // namespace inverse
