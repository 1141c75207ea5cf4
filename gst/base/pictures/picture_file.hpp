// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "kernels/image/plane.hpp"

namespace inverse {

/// A picture in 8 bits: sRGB and alpha, row by row from the top.
struct Picture8 {
  Extent extent;
  std::vector<uint8_t> rgba;
};

/// Reads a PNG or JPEG file, and turns it as its EXIF tag says unless it is to stay as it is
/// stored. Throws Error(file), which names the file, if it cannot be read, is damaged, is of
/// another kind, or has more than kMaxPixels.
enum class Turn { by_exif, none };
Picture8 load_picture(const std::string& path, Turn turn = Turn::by_exif);
constexpr uint64_t kMaxPixels = uint64_t{1} << 27;

/// The orientation in the EXIF data of a JPEG or PNG file, 1…8; 1 if it has none.
int exif_orientation(const std::string& file);
/// The picture as it is meant to be seen, of one that was stored with this orientation.
Picture8 oriented(Picture8 picture, int orientation);

/// Linear RGB and alpha, four numbers a pixel.
struct LinearPicture {
  Extent extent;
  std::vector<float> rgba;
};
/// In linear light, reduced by the smallest whole factor by which neither side exceeds `max_side`.
LinearPicture linear_picture(const Picture8& picture, uint32_t max_side);

}  // namespace inverse
