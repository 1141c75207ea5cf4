// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "kernels/image/plane.hpp"
#include "primaries.hpp"
#include "transfer.hpp"

namespace inverse {

/// Where the samples of one component lie in the rows of its plane. Offset and stride count units
/// (PixelFormat::unit): sample i of a row starts at offset + i·stride.
struct Component {
  uint8_t plane = 0, offset = 0, stride = 0;
  uint8_t shift = 0;  ///< of the code in its unit
  uint8_t depth = 0;  ///< bits of the code; 0: there is no such component
  bool operator==(const Component&) const = default;
};

/// What a code is read from. Offsets and strides of all but `thirds` count bytes.
enum class Unit : uint8_t {
  byte,
  le16,
  be16,
  le32,
  be32,
  thirds,  ///< ten bits, three in a little-endian word of 32: the unit is one of them
};

/// How samples lie in memory. The members are the formats that have kernels of their own, by
/// GStreamer's names (GstVideoFormat) in lower case; the others are described by who needs them,
/// and share a kernel.
struct PixelFormat {
  enum class Model : uint8_t { gray, rgb, yuv };

  std::string_view name;  ///< GStreamer's
  Model model = Model::rgb;
  Unit unit = Unit::byte;
  uint8_t planes = 1;
  uint8_t w_sub = 0, h_sub = 0;  ///< log2 of the subsampling of chroma: at most 2 and 1
  /// Y' or R', G', B'; or Y', Cb, Cr; then alpha. A fourth component that is not alpha is ignored,
  /// and written as all ones.
  std::array<Component, 4> components{};
  bool alpha = false;
  bool operator==(const PixelFormat&) const = default;

  static const PixelFormat rgba, bgra, rgbx, bgrx, rgb, bgr, rgba64_le, gray8, gray16_le, nv12,
      i420, yuy2, uyvy, p010_10le, i420_10le;
};

/// R, G and B of eight bits at these bytes of every `stride`, which may have a fourth.
constexpr PixelFormat packed_rgb(std::string_view name, std::array<uint8_t, 3> at, uint8_t stride,
                                 bool alpha = false) {
  PixelFormat format{name};
  for (size_t c = 0; c < 3; ++c) format.components[c] = {0, at[c], stride, 0, 8};
  if (stride == 4) format.components[3] = {0, 3, 4, 0, 8};
  format.alpha = alpha;
  return format;
}

inline constexpr PixelFormat PixelFormat::rgba = packed_rgb("RGBA", {0, 1, 2}, 4, true);
inline constexpr PixelFormat PixelFormat::bgra = packed_rgb("BGRA", {2, 1, 0}, 4, true);
inline constexpr PixelFormat PixelFormat::rgbx = packed_rgb("RGBx", {0, 1, 2}, 4);
inline constexpr PixelFormat PixelFormat::bgrx = packed_rgb("BGRx", {2, 1, 0}, 4);
inline constexpr PixelFormat PixelFormat::rgb = packed_rgb("RGB", {0, 1, 2}, 3);
inline constexpr PixelFormat PixelFormat::bgr = packed_rgb("BGR", {2, 1, 0}, 3);
inline constexpr PixelFormat PixelFormat::rgba64_le{
    "RGBA64_LE",
    Model::rgb,
    Unit::le16,
    1,
    0,
    0,
    {{{0, 0, 8, 0, 16}, {0, 2, 8, 0, 16}, {0, 4, 8, 0, 16}, {0, 6, 8, 0, 16}}},
    true};
inline constexpr PixelFormat PixelFormat::gray8{"GRAY8", Model::gray, Unit::byte,         1,
                                                0,       0,           {{{0, 0, 1, 0, 8}}}};
inline constexpr PixelFormat PixelFormat::gray16_le{
    "GRAY16_LE", Model::gray, Unit::le16, 1, 0, 0, {{{0, 0, 2, 0, 16}}}};
inline constexpr PixelFormat PixelFormat::nv12{
    "NV12", Model::yuv, Unit::byte, 2, 1, 1, {{{0, 0, 1, 0, 8}, {1, 0, 2, 0, 8}, {1, 1, 2, 0, 8}}}};
inline constexpr PixelFormat PixelFormat::i420{
    "I420", Model::yuv, Unit::byte, 3, 1, 1, {{{0, 0, 1, 0, 8}, {1, 0, 1, 0, 8}, {2, 0, 1, 0, 8}}}};
inline constexpr PixelFormat PixelFormat::yuy2{
    "YUY2", Model::yuv, Unit::byte, 1, 1, 0, {{{0, 0, 2, 0, 8}, {0, 1, 4, 0, 8}, {0, 3, 4, 0, 8}}}};
inline constexpr PixelFormat PixelFormat::uyvy{
    "UYVY", Model::yuv, Unit::byte, 1, 1, 0, {{{0, 1, 2, 0, 8}, {0, 0, 4, 0, 8}, {0, 2, 4, 0, 8}}}};
inline constexpr PixelFormat PixelFormat::p010_10le{
    "P010_10LE",
    Model::yuv,
    Unit::le16,
    2,
    1,
    1,
    {{{0, 0, 2, 6, 10}, {1, 0, 4, 6, 10}, {1, 2, 4, 6, 10}}}};
inline constexpr PixelFormat PixelFormat::i420_10le{
    "I420_10LE",
    Model::yuv,
    Unit::le16,
    3,
    1,
    1,
    {{{0, 0, 2, 0, 10}, {1, 0, 2, 0, 10}, {2, 0, 2, 0, 10}}}};

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
  Gamut gamut;  ///< of Pack: from the primaries of planes to those of the frame
  bool operator==(const FrameFormat&) const = default;
};

/// Bytes per row and number of rows of a plane of a format.
uint32_t row_bytes(const PixelFormat& format, Extent extent, uint32_t plane);
uint32_t plane_rows(const PixelFormat& format, Extent extent, uint32_t plane);
inline bool is_yuv(const PixelFormat& format) { return format.model == PixelFormat::Model::yuv; }
/// Significant bits of a sample of luma or red, 5 to 16; other colors may have one more.
inline uint32_t bit_depth(const PixelFormat& format) { return format.components[0].depth; }

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
void copy_plane(const PixelFormat& format, Extent extent, uint32_t plane, const void* source,
                size_t source_stride, void* target, size_t target_stride);

/// Throws Error(unsupported) with the cause for an empty frame, strides shorter than rows, a frame
/// of more than 4 GiB, or a Y'CbCr format without a matrix.
void validate(const FrameFormat& format);

/// Code range of one kind of sample, at the depth of luma or red: code = value·scale + offset, and
/// the largest code.
struct CodeScale {
  float scale, offset, largest;
};
CodeScale luma_codes(const FrameFormat& format);    ///< value 0…1; also R', G', B'
CodeScale chroma_codes(const FrameFormat& format);  ///< value -½…½

}  // namespace inverse
