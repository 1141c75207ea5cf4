// Reading PNG files, without libraries but zlib.
#pragma once

#include <string>

#include "tests/bench/image.hpp"

namespace inverse::bench {

/// Reads a PNG of 8 or 16 bits (gray or RGB, with or without alpha, which is dropped; not
/// interlaced, no palette). Codes become 0…1; `decode_srgb` takes 8-bit codes through the sRGB
/// curve to linear light, 16-bit codes are linear already. Throws std::runtime_error.
Image read_png(const std::string& path, bool decode_srgb);

}  // namespace inverse::bench
