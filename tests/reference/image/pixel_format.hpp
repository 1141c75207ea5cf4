// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernels/image/format/pixel_format.hpp"

namespace inverse::reference {

/// Meaning of a frame's samples, pixel by pixel from the definitions, in double precision. Pixels
/// are four interleaved numbers.

/// Codes of one pixel: luma, or R, G, B; the last is alpha (0 if there is none).
struct Codes {
  uint32_t value[4];
};
/// Reads the codes of a pixel, and the chroma codes (Cb, Cr) of a chroma sample.
Codes pixel_codes(const FrameFormat& format, const std::vector<std::byte>& bytes, uint32_t x,
                  uint32_t y);
void set_pixel_codes(const FrameFormat& format, std::vector<std::byte>& bytes, uint32_t x,
                     uint32_t y, const Codes& codes);
Codes chroma_codes_at(const FrameFormat& format, const std::vector<std::byte>& bytes, uint32_t x,
                      uint32_t y);
void set_chroma_codes(const FrameFormat& format, std::vector<std::byte>& bytes, uint32_t x,
                      uint32_t y, const Codes& codes);
/// Chroma samples across and down; {0, 0} for RGB and gray.
Extent chroma_extent(const FrameFormat& format);
/// How many colors a pixel has: R, G, B, or luma alone.
uint32_t components(const PixelFormat& format);

/// Linear light of a frame, w = alpha.
std::vector<double> unpack(const FrameFormat& format, const std::vector<std::byte>& bytes);

/// The bytes of a frame (padding zero) from a picture: rgb, or w as gray if `shading`; alpha
/// from another picture's w, null for opaque.
std::vector<std::byte> pack(const FrameFormat& format, const std::vector<float>& picture,
                            bool shading, float gain, const std::vector<float>* alpha);

}  // namespace inverse::reference
