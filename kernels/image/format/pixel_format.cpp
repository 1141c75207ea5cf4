// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pixel_format.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "common/error.hpp"

namespace inverse {
namespace {

bool is_chroma(const PixelFormat& format, size_t component) {
  return is_yuv(format) && (component == 1 || component == 2);
}

/// Samples of so many pixels.
uint32_t halved(uint32_t pixels, uint32_t times) { return (pixels + (1u << times) - 1) >> times; }

std::string size_text(Extent extent) {
  return std::to_string(extent.width) + "x" + std::to_string(extent.height);
}

}  // namespace

uint32_t row_bytes(const PixelFormat& format, Extent extent, uint32_t plane) {
  uint32_t units = 0;
  for (size_t c = 0; c < format.components.size(); ++c) {
    const Component& component = format.components[c];
    if (component.depth == 0 || component.plane != plane) continue;
    const uint32_t samples =
        is_chroma(format, c) ? halved(extent.width, format.w_sub) : extent.width;
    units = std::max(units, samples * component.stride);
  }
  return format.unit == Unit::thirds ? (units + 2) / 3 * 4 : units;
}

uint32_t plane_rows(const PixelFormat& format, Extent extent, uint32_t plane) {
  for (size_t c = 0; c < format.components.size(); ++c)
    if (format.components[c].depth > 0 && format.components[c].plane == plane)
      return is_chroma(format, c) ? halved(extent.height, format.h_sub) : extent.height;
  return 0;
}

uint64_t frame_bytes(const FrameFormat& format) {
  uint64_t end = 0;
  for (uint32_t p = 0; p < format.format.planes; ++p) {
    const uint64_t rows = plane_rows(format.format, format.extent, p);
    end = std::max(end, format.offset[p] + (rows - 1) * format.stride[p] +
                            row_bytes(format.format, format.extent, p));
  }
  return end;
}

FrameFormat aligned_layout(FrameFormat format, uint32_t alignment) {
  uint64_t end = 0;
  for (uint32_t p = 0; p < format.format.planes; ++p) {
    const uint32_t row = row_bytes(format.format, format.extent, p);
    format.offset[p] = static_cast<uint32_t>(end);
    format.stride[p] = (row + alignment - 1) & ~(alignment - 1);
    end += static_cast<uint64_t>(format.stride[p]) * plane_rows(format.format, format.extent, p);
  }
  return format;
}

bool is_word_aligned(const FrameFormat& format) {
  for (uint32_t p = 0; p < format.format.planes; ++p)
    if (format.offset[p] % 4 || format.stride[p] % 4) return false;
  return true;
}

void copy_plane(const PixelFormat& format, Extent extent, uint32_t plane, const void* source,
                size_t source_stride, void* target, size_t target_stride) {
  const size_t bytes = row_bytes(format, extent, plane), rows = plane_rows(format, extent, plane);
  if (source_stride == target_stride) {
    // One copy includes the padding, except after the last row, which may have none.
    std::memcpy(target, source, (rows - 1) * source_stride + bytes);
    return;
  }
  for (size_t row = 0; row < rows; ++row)
    std::memcpy(static_cast<std::byte*>(target) + row * target_stride,
                static_cast<const std::byte*>(source) + row * source_stride, bytes);
}

void validate(const FrameFormat& format) {
  const std::string what =
      "a " + std::string(format.format.name) + " frame of " + size_text(format.extent);
  if (format.extent.width == 0 || format.extent.height == 0)
    throw Error(ErrorKind::unsupported, what + " has no pixels");
  for (uint32_t p = 0; p < format.format.planes; ++p)
    if (plane_rows(format.format, format.extent, p) > 1 &&
        format.stride[p] < row_bytes(format.format, format.extent, p))
      throw Error(ErrorKind::unsupported,
                  what + " has rows of " +
                      std::to_string(row_bytes(format.format, format.extent, p)) +
                      " bytes in plane " + std::to_string(p) + " but a stride of only " +
                      std::to_string(format.stride[p]));
  if (frame_bytes(format) > UINT32_MAX)
    throw Error(ErrorKind::unsupported, what + " needs more than 4 GiB");
  if (is_yuv(format.format) && format.matrix.is_identity())
    throw Error(ErrorKind::unsupported,
                what +
                    " is Y'CbCr but its colorimetry names no Y'CbCr matrix (identity); set one "
                    "in the caps, for example colorimetry=bt709");
}

CodeScale luma_codes(const FrameFormat& format) {
  const uint32_t depth = bit_depth(format.format);
  const auto largest = static_cast<float>((1u << depth) - 1);
  if (format.range == Range::full) return {largest, 0, largest};
  const float unit = std::ldexp(1.0f, static_cast<int>(depth) - 8);
  return {219 * unit, 16 * unit, largest};
}

CodeScale chroma_codes(const FrameFormat& format) {
  const uint32_t depth = bit_depth(format.format);
  const auto largest = static_cast<float>((1u << depth) - 1);
  const float unit = std::ldexp(1.0f, static_cast<int>(depth) - 8);
  return {format.range == Range::full ? largest : 224 * unit, 128 * unit, largest};
}

}  // namespace inverse
