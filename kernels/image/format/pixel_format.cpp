// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pixel_format.hpp"

#include <algorithm>
#include <cstring>
#include <string>

#include "common/error.hpp"

namespace inverse {
namespace {

struct Traits {
  const char* name;
  uint32_t planes;
  uint32_t depth;        // significant bits
  uint32_t pixel_bytes;  // of plane 0
  bool yuv, alpha;
  uint32_t chroma_bytes;  // of a chroma sample (pair) in plane 1; 0: no chroma planes
};

const Traits& traits(PixelFormat format) {
  static constexpr Traits kTraits[] = {
      {"RGBA", 1, 8, 4, false, true, 0},        {"BGRA", 1, 8, 4, false, true, 0},
      {"RGBx", 1, 8, 4, false, false, 0},       {"BGRx", 1, 8, 4, false, false, 0},
      {"RGB", 1, 8, 3, false, false, 0},        {"BGR", 1, 8, 3, false, false, 0},
      {"RGBA64_LE", 1, 16, 8, false, true, 0},  {"GRAY8", 1, 8, 1, false, false, 0},
      {"GRAY16_LE", 1, 16, 2, false, false, 0}, {"NV12", 2, 8, 1, true, false, 2},
      {"I420", 3, 8, 1, true, false, 1},        {"YUY2", 1, 8, 2, true, false, 0},
      {"UYVY", 1, 8, 2, true, false, 0},        {"P010_10LE", 2, 10, 2, true, false, 4},
      {"I420_10LE", 3, 10, 2, true, false, 2},
  };
  static_assert(std::size(kTraits) == static_cast<size_t>(PixelFormat::i420_10le) + 1);
  return kTraits[static_cast<size_t>(format)];
}

std::string size_text(Extent extent) {
  return std::to_string(extent.width) + "x" + std::to_string(extent.height);
}

}  // namespace

const char* name_of(PixelFormat format) { return traits(format).name; }
uint32_t plane_count(PixelFormat format) { return traits(format).planes; }
bool has_alpha(PixelFormat format) { return traits(format).alpha; }
bool is_yuv(PixelFormat format) { return traits(format).yuv; }
uint32_t bit_depth(PixelFormat format) { return traits(format).depth; }

uint32_t row_bytes(PixelFormat format, Extent extent, uint32_t plane) {
  const Traits& t = traits(format);
  if (plane > 0) return (extent.width + 1) / 2 * t.chroma_bytes;
  // Packed 4:2:2 has whole pairs.
  const bool pairs = format == PixelFormat::yuy2 || format == PixelFormat::uyvy;
  return (pairs ? (extent.width + 1) / 2 * 2 : extent.width) * t.pixel_bytes;
}

uint32_t plane_rows(PixelFormat, Extent extent, uint32_t plane) {
  return plane > 0 ? (extent.height + 1) / 2 : extent.height;
}

uint64_t frame_bytes(const FrameFormat& format) {
  uint64_t end = 0;
  for (uint32_t p = 0; p < plane_count(format.format); ++p) {
    const uint64_t rows = plane_rows(format.format, format.extent, p);
    end = std::max(end, format.offset[p] + (rows - 1) * format.stride[p] +
                            row_bytes(format.format, format.extent, p));
  }
  return end;
}

FrameFormat aligned_layout(FrameFormat format, uint32_t alignment) {
  uint64_t end = 0;
  for (uint32_t p = 0; p < plane_count(format.format); ++p) {
    const uint32_t row = row_bytes(format.format, format.extent, p);
    format.offset[p] = static_cast<uint32_t>(end);
    format.stride[p] = (row + alignment - 1) & ~(alignment - 1);
    end += static_cast<uint64_t>(format.stride[p]) * plane_rows(format.format, format.extent, p);
  }
  return format;
}

bool is_word_aligned(const FrameFormat& format) {
  for (uint32_t p = 0; p < plane_count(format.format); ++p)
    if (format.offset[p] % 4 || format.stride[p] % 4) return false;
  return true;
}

void copy_plane(PixelFormat format, Extent extent, uint32_t plane, const void* source,
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
      std::string("a ") + name_of(format.format) + " frame of " + size_text(format.extent);
  if (format.extent.width == 0 || format.extent.height == 0)
    throw Error(ErrorKind::unsupported, what + " has no pixels");
  for (uint32_t p = 0; p < plane_count(format.format); ++p)
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
  const auto unit = static_cast<float>(1u << (depth - 8));
  return {219 * unit, 16 * unit, largest};
}

CodeScale chroma_codes(const FrameFormat& format) {
  const uint32_t depth = bit_depth(format.format);
  const auto largest = static_cast<float>((1u << depth) - 1);
  const auto unit = static_cast<float>(1u << (depth - 8));
  return {format.range == Range::full ? largest : 224 * unit, 128 * unit, largest};
}

}  // namespace inverse
