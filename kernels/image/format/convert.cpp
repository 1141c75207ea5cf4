// SPDX-License-Identifier: LGPL-2.1-or-later
#include "convert.hpp"

#include <algorithm>
#include <string>

#include "common/error.hpp"

namespace inverse {
namespace {

using Push = shaders::image_format_pack_rgb::Push;  // the same in all these kernels
constexpr uint32_t kStripRows = shaders::image_format_pack_rgb::ROWS;  // in all of them
constexpr uint32_t kStrips = TileList::kTile / kStripRows;

/// Words per plane.
gpu::Vector<uint32_t, 4> words_of(const FrameFormat& format, const auto& bytes) {
  std::array<uint32_t, 4> words{};
  for (uint32_t p = 0; p < plane_count(format.format); ++p)
    words[p] = static_cast<uint32_t>(bytes[p] / 4);
  return words;
}

double largest_value(const CodeScale& codes) {
  return (codes.largest - codes.offset) / codes.scale;
}

/// Specialization constants of the RGB and gray kernels.
template <typename Shader>
typename Shader::Constants rgb_constants(const FrameFormat& format) {
  const bool bgr = format.format == PixelFormat::bgra || format.format == PixelFormat::bgrx ||
                   format.format == PixelFormat::bgr;
  return {.curve = !format.transfer.is_linear(),
          .pixel = row_bytes(format.format, {1, 1}, 0),
          .bgr = bgr,
          .alpha = has_alpha(format.format)};
}

/// Specialization constants of the Y'CbCr kernels (yuv.glsl).
template <typename Shader>
typename Shader::Constants yuv_constants(const FrameFormat& format) {
  uint32_t layout = Shader::kSemiPlanar;
  if (plane_count(format.format) == 3) layout = Shader::kPlanar;
  if (format.format == PixelFormat::yuy2) layout = Shader::kYuy2;
  if (format.format == PixelFormat::uyvy) layout = Shader::kUyvy;
  return {.curve = !format.transfer.is_linear(),
          .layout = layout,
          .deep = bit_depth(format.format) > 8,
          .shift = format.format == PixelFormat::p010_10le ? 6U : 0U,
          .cosited_x = format.site.cosited_x,
          .cosited_y = format.site.cosited_y};
}

void check_layout(const FrameFormat& format) {
  validate(format);
  if (!is_word_aligned(format))
    throw Error(ErrorKind::unsupported,
                std::string("a ") + name_of(format.format) +
                    " frame whose offsets or strides are not multiples of four must be copied to "
                    "its aligned layout first");
}

void check_planes(const FrameFormat& format, const gpu::BufferPtr& raw, const Plane* plane) {
  if (plane && plane->extent != format.extent)
    throw Error(ErrorKind::internal, "plane and frame differ in size");
  if (raw->count() < raw_words(format))
    throw Error(ErrorKind::internal, "the raw buffer is shorter than the frame");
}

/// Pixels of a row that an invocation of the kernel for Y'CbCr draws.
uint32_t drawn_at_once(const FrameFormat& format) {
  return format.format == PixelFormat::i420 ? 8 : 4;
}

uint32_t blocks(uint32_t pixels, uint32_t size) { return (pixels + size - 1) / size; }

}  // namespace

uint64_t raw_words(const FrameFormat& format) { return (frame_bytes(format) + 3) / 4; }

Unpack::Unpack(const std::shared_ptr<gpu::Device>& device, const FrameFormat& format)
    : format_(format) {
  check_layout(format);
  using shaders::image_format_unpack_rgb, shaders::image_format_unpack_yuv;
  if (is_yuv(format.format))
    yuv_ = {device, yuv_constants<image_format_unpack_yuv>(format), 4, kStrips};
  else
    rgb_ = {device, rgb_constants<image_format_unpack_rgb>(format), 4, kStrips};
}

void Unpack::record(gpu::Commands& commands, const gpu::BufferPtr& raw, const Plane& linear,
                    const TileList* listed) const {
  check_planes(format_, raw, &linear);
  const CodeScale luma = luma_codes(format_), chroma = chroma_codes(format_);
  const double kr = format_.matrix.kr, kb = format_.matrix.kb, kg = 1 - kr - kb;
  const Transfer& t = format_.transfer;
  const Push push{
      .size = format_.extent,
      .words = static_cast<uint32_t>(raw_words(format_)),
      .flags = 0,
      .offset = words_of(format_, format_.offset),
      .stride = words_of(format_, format_.stride),
      .codes = {luma.offset, 1 / luma.scale, chroma.offset, 1 / chroma.scale},
      .matrix = {static_cast<float>(2 * (1 - kr)), static_cast<float>(-2 * (1 - kb) * kb / kg),
                 static_cast<float>(-2 * (1 - kr) * kr / kg), static_cast<float>(2 * (1 - kb))},
      .curve = {t.start, t.slope, t.scale, t.offset},
      .power = t.power,
      .ceiling = static_cast<float>(largest_value(luma)),
      .gain = 0,
      .largest = 0};
  const gpu::Items items{blocks(format_.extent.width, 4),
                         blocks(format_.extent.height, kStripRows)};
  if (is_yuv(format_.format))
    yuv_.dispatch(commands, listed, {.raw = raw, .linear = linear.buffer}, push, items);
  else
    rgb_.dispatch(commands, listed, {.raw = raw, .linear = linear.buffer}, push, items);
}

Pack::Pack(const std::shared_ptr<gpu::Device>& device, const FrameFormat& format)
    : format_(format) {
  check_layout(format);
  using shaders::image_format_pack_rgb, shaders::image_format_pack_yuv;
  if (is_yuv(format.format))
    yuv_ = {device, yuv_constants<image_format_pack_yuv>(format),
            TileList::kTile / drawn_at_once(format), kStrips};
  else
    rgb_ = {device, rgb_constants<image_format_pack_rgb>(format), 4, kStrips};
}

void Pack::record(gpu::Commands& commands, const Drawing& drawing, const gpu::BufferPtr& raw,
                  const TileList* listed) const {
  check_planes(format_, raw, &drawing.picture);
  check_planes(format_, raw, drawing.alpha);
  using Shader = shaders::image_format_pack_rgb;
  const uint32_t shading = drawing.source == Drawing::Source::shading ? Shader::kFlagShading : 0;
  const uint32_t opaque = drawing.alpha ? 0 : Shader::kFlagOpaque;
  const CodeScale luma = luma_codes(format_), chroma = chroma_codes(format_);
  const Matrix matrix = format_.matrix.is_identity() ? Matrix::bt709() : format_.matrix;
  const Transfer& t = format_.transfer;
  const Push push{.size = format_.extent,
                  .words = static_cast<uint32_t>(raw_words(format_)),
                  .flags = shading | opaque,
                  .offset = words_of(format_, format_.offset),
                  .stride = words_of(format_, format_.stride),
                  .codes = {luma.offset, luma.scale, chroma.offset, chroma.scale},
                  .matrix = {matrix.kr, matrix.kb, 0.5f / (1 - matrix.kb), 0.5f / (1 - matrix.kr)},
                  .curve = {static_cast<float>(t.linear_start()), 1 / t.slope, 1 / t.scale,
                            -t.offset / t.scale},
                  .power = 1 / t.power,
                  .ceiling = static_cast<float>(t.decode(largest_value(luma))),
                  .gain = drawing.gain,
                  .largest = luma.largest};
  const Extent extent = format_.extent;
  const gpu::BufferPtr& picture = drawing.picture.buffer;
  if (is_yuv(format_.format))
    yuv_.dispatch(
        commands, listed, {.picture = picture, .raw = raw}, push,
        {blocks(extent.width, drawn_at_once(format_)), blocks(extent.height, kStripRows)});
  else
    rgb_.dispatch(commands, listed,
                  {.picture = picture,
                   .alpha_plane = drawing.alpha ? drawing.alpha->buffer : picture,
                   .raw = raw},
                  push, {blocks(extent.width, 4), blocks(extent.height, kStripRows)});
}

}  // namespace inverse
