// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "kernels/image/plane.hpp"
#include "transfer.hpp"

namespace inverse {

/// How samples lie in memory. The names are GStreamer's (GstVideoFormat) in lower case.
enum class PixelFormat : uint8_t {
  rgba,
  bgra,
  rgbx,  ///< as rgba; the fourth byte is ignored, and written as 255
  bgrx,
  rgb,
  bgr,
  rgba64_le,  ///< four 16-bit numbers a pixel
  gray8,
  gray16_le,
  nv12,
  i420,
  yuy2,
  uyvy,
  p010_10le,  ///< as nv12, ten bits in the high bits of 16
  i420_10le,  ///< as i420, ten bits in the low bits of 16
};
const char* name_of(PixelFormat format);

enum class Range : uint8_t {
  full,     ///< black 0, white 2^depth − 1
  limited,  ///< black 16, white 235, chroma 16…240, times 2^(depth − 8)
};

/// Y' = kr·R' + (1 - kr - kb)·G' + kb·B'. All zero is the identity, allowed for RGB only; gray
/// formats then use BT.709's weights.
struct Matrix {
  float kr = 0, kb = 0;
  bool operator==(const Matrix&) const = default;
  bool is_identity() const { return kr == 0 && kb == 0; }
  static constexpr Matrix bt601() { return {0.299f, 0.114f}; }
  static constexpr Matrix bt709() { return {0.2126f, 0.0722f}; }
  static constexpr Matrix bt2020() { return {0.2627f, 0.0593f}; }
  static constexpr Matrix smpte240m() { return {0.212f, 0.087f}; }
  static constexpr Matrix fcc() { return {0.30f, 0.11f}; }
};

/// Position of a subsampled chroma sample: at the left (top) luma sample of its pair, or midway.
struct ChromaSite {
  bool cosited_x = true, cosited_y = false;  // MPEG-2, the usual one for video
  bool operator==(const ChromaSite&) const = default;
};

/// Layout and colorimetry of a progressive frame in memory.
struct FrameFormat {
  PixelFormat format = PixelFormat::rgba;
  Extent extent;
  std::array<uint32_t, 4> offset{};  ///< of each plane's first byte
  std::array<uint32_t, 4> stride{};  ///< bytes from row to row of each plane
  Matrix matrix;                     ///< needed by Y'CbCr formats, ignored by RGB ones
  Range range = Range::full;         ///< of color and luma; alpha is always full
  Transfer transfer;
  ChromaSite site;
  bool operator==(const FrameFormat&) const = default;
};

/// Number of planes of a format; bytes per row and rows of one of them.
uint32_t plane_count(PixelFormat format);
uint32_t row_bytes(PixelFormat format, Extent extent, uint32_t plane);
uint32_t plane_rows(PixelFormat format, Extent extent, uint32_t plane);
bool has_alpha(PixelFormat format);
bool is_yuv(PixelFormat format);  ///< neither RGB nor gray
/// Significant bits of a sample: 8, 10 or 16.
uint32_t bit_depth(PixelFormat format);

/// Bytes from the start of the frame to the end of its last row. The last row of a plane may lack
/// its padding.
uint64_t frame_bytes(const FrameFormat& format);

/// The same frame with consecutive planes and rows padded to a multiple of `alignment` bytes (a
/// power of two, at least 4), as Unpack and Pack require. 4 gives GStreamer's strides.
FrameFormat aligned_layout(FrameFormat format, uint32_t alignment = 4);
/// Whether Unpack and Pack accept this layout: offsets and strides are multiples of 4.
bool is_word_aligned(const FrameFormat& format);

/// Copies the rows of one plane between two layouts, strides in bytes. Copies padding only if the
/// strides are equal.
void copy_plane(PixelFormat format, Extent extent, uint32_t plane, const void* source,
                size_t source_stride, void* target, size_t target_stride);

/// Throws Error(unsupported) with the cause for an empty frame, strides shorter than rows, a frame
/// of more than 4 GiB, or a Y'CbCr format without a matrix.
void validate(const FrameFormat& format);

/// Code range of one kind of sample: code = value·scale + offset, and the largest code.
struct CodeScale {
  float scale, offset, largest;
};
CodeScale luma_codes(const FrameFormat& format);    ///< value 0…1; also R', G', B'
CodeScale chroma_codes(const FrameFormat& format);  ///< value -½…½

}  // namespace inverse
