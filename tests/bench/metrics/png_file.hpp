// SPDX-License-Identifier: LGPL-2.1-or-later
// PNG files.
#pragma once

#include <string>

#include "image.hpp"

namespace inverse::bench {

/// Reads a PNG of 8 or 16 bits, gray or RGB; alpha is dropped. Codes become 0…1; `decode_srgb`
/// takes 8-bit codes through the sRGB curve to linear light, 16-bit codes are linear already.
/// Throws std::runtime_error.
Image read_png(const std::string& path, bool decode_srgb);

/// Writes an image of 1 or 3 channels of linear light, cut to 0…1, as sRGB codes of 8 bits. Throws
/// std::runtime_error.
void write_png(const std::string& path, const Image& linear);

}  // namespace inverse::bench
