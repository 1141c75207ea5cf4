// SPDX-License-Identifier: LGPL-2.1-or-later
#include "convert.hpp"

#include <algorithm>
#include <string>

#include "common/error.hpp"

namespace inverse {
namespace {

using Push = shaders::image_format_pack_rgb::Push;  // the same in all these kernels
constexpr uint32_t kStripRows = shaders::image_format_pack_rgb::ROWS;  // in all of them

/// Words per plane.
gpu::Vector<uint32_t, 4> words_of(const FrameFormat& format, const auto& bytes) {
  std::array<uint32_t, 4> words{};
  for (uint32_t p = 0; p < format.format.planes; ++p)
    words[p] = static_cast<uint32_t>(bytes[p] / 4);
  return words;
}

double largest_value(const CodeScale& codes) {
  return (codes.largest - codes.offset) / codes.scale;
}

template <typename Shader>
uint32_t curve_of(const Transfer& transfer) {
  switch (transfer.curve) {
    case Transfer::Curve::pq:
      return Shader::kPq;
    case Transfer::Curve::hlg:
      return Shader::kHlg;
    case Transfer::Curve::power:
      break;
  }
  return transfer.is_linear() ? Shader::kLinear : Shader::kPower;
}

/// Specialization constants of the RGB and gray kernels.
template <typename Shader>
typename Shader::Constants rgb_constants(const FrameFormat& format) {
  const PixelFormat& f = format.format;
  return {.curve = curve_of<Shader>(format.transfer),
          .pixel = row_bytes(f, {1, 1}, 0),
          .bgr = f.components[0].offset > 0,
          .alpha = f.alpha};
}

/// Specialization constants of the Y'CbCr kernels (yuv.glsl).
template <typename Shader>
typename Shader::Constants yuv_constants(const FrameFormat& format) {
  const PixelFormat& f = format.format;
  uint32_t layout = Shader::kSemiPlanar;
  if (f.planes == 3) layout = Shader::kPlanar;
  if (f == PixelFormat::yuy2) layout = Shader::kYuy2;
  if (f == PixelFormat::uyvy) layout = Shader::kUyvy;
  return {.curve = curve_of<Shader>(format.transfer),
          .layout = layout,
          .deep = f.unit == Unit::le16,
          .shift = f.components[0].shift,
          .cosited_x = format.site.cosited_x,
          .cosited_y = format.site.cosited_y};
}

uint32_t word_of(const Component& c) {
  return c.plane | c.offset << 2 | c.stride << 6 | c.shift << 10 |
         static_cast<uint32_t>(c.depth) << 15;
}

/// Specialization constants of the kernels for any format (samples.glsl).
template <typename Shader>
typename Shader::Constants table_constants(const FrameFormat& format) {
  const PixelFormat& f = format.format;
  return {.curve = curve_of<Shader>(format.transfer),
          .model = static_cast<uint32_t>(f.model),
          .unit = static_cast<uint32_t>(f.unit),
          .w_sub = f.w_sub,
          .h_sub = f.h_sub,
          .cosited_x = format.site.cosited_x,
          .cosited_y = format.site.cosited_y,
          .alpha = f.alpha,
          .component0 = word_of(f.components[0]),
          .component1 = word_of(f.components[1]),
          .component2 = word_of(f.components[2]),
          .component3 = word_of(f.components[3])};
}

/// With the matrix of draw.glsl.
template <typename Constants>
Constants with_gamut(Constants constants, const Gamut& gamut) {
  const std::array<float, 9>& m = gamut.matrix;
  constants.gamut = !gamut.is_identity();
  constants.red_red = m[0];
  constants.red_green = m[1];
  constants.red_blue = m[2];
  constants.green_red = m[3];
  constants.green_green = m[4];
  constants.green_blue = m[5];
  constants.blue_red = m[6];
  constants.blue_green = m[7];
  constants.blue_blue = m[8];
  return constants;
}

enum class Kernel { rgb, yuv, table };

Kernel kernel_of(const PixelFormat& format) {
  const auto is_one_of = [&](std::initializer_list<PixelFormat> formats) {
    return std::find(formats.begin(), formats.end(), format) != formats.end();
  };
  using F = PixelFormat;
  if (is_one_of({F::rgba, F::bgra, F::rgbx, F::bgrx, F::rgb, F::bgr, F::rgba64_le, F::gray8,
                 F::gray16_le}))
    return Kernel::rgb;
  if (is_one_of({F::nv12, F::i420, F::yuy2, F::uyvy, F::p010_10le, F::i420_10le}))
    return Kernel::yuv;
  return Kernel::table;
}

void check_layout(const FrameFormat& format) {
  validate(format);
  if (!is_word_aligned(format))
    throw Error(ErrorKind::unsupported,
                "a " + std::string(format.format.name) +
                    " frame whose offsets or strides are not multiples of four must be copied to "
                    "its aligned layout first");
}

void check_planes(const FrameFormat& format, const gpu::BufferPtr& raw, const Plane* plane) {
  if (plane && plane->extent != format.extent)
    throw Error(ErrorKind::internal, "plane and frame differ in size");
  if (raw->count() < raw_words(format))
    throw Error(ErrorKind::internal, "the raw buffer is shorter than the frame");
}

/// Pixels of a row that an invocation of pack_yuv or pack_table draws: whole words of every plane.
uint32_t drawn_at_once(const PixelFormat& format) {
  if (format.unit == Unit::thirds) return 12;
  uint32_t pixels = 4;
  for (uint32_t p = 0; p < format.planes; ++p)
    while (row_bytes(format, {pixels, 1}, p) % 4 > 0) pixels *= 2;
  return pixels;
}

uint32_t blocks(uint32_t pixels, uint32_t size) { return (pixels + size - 1) / size; }

}  // namespace

uint64_t raw_words(const FrameFormat& format) {
  // The only plane's last row is as long as the others, so that rows can be bound by.
  if (format.format.planes == 1)
    return (format.offset[0] + uint64_t{format.extent.height} * format.stride[0]) / 4;
  return (frame_bytes(format) + 3) / 4;
}

Unpack::Unpack(const std::shared_ptr<gpu::Device>& device, const FrameFormat& format)
    : format_(format) {
  check_layout(format);
  using shaders::image_format_unpack_rgb, shaders::image_format_unpack_table,
      shaders::image_format_unpack_yuv;
  switch (kernel_of(format.format)) {
    case Kernel::rgb:
      rgb_.emplace(device, rgb_constants<image_format_unpack_rgb>(format));
      break;
    case Kernel::yuv:
      yuv_.emplace(device, yuv_constants<image_format_unpack_yuv>(format));
      break;
    case Kernel::table:
      table_.emplace(device, table_constants<image_format_unpack_table>(format));
  }
}

void Unpack::record(gpu::Commands& commands, const gpu::BufferPtr& raw, const Plane& linear) const {
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
      .largest = 0,
      .first_row = 0};
  const gpu::Rows rows{blocks(format_.extent.width, 4), format_.extent.height, kStripRows};
  const auto dispatch = [&](const auto& program) {
    if (program)
      commands.dispatch_rows(*program, {.raw = raw, .linear = gpu::by_rows(linear.buffer)}, push,
                             rows);
  };
  dispatch(rgb_);
  dispatch(yuv_);
  dispatch(table_);
}

Pack::Pack(const std::shared_ptr<gpu::Device>& device, const FrameFormat& format)
    : format_(format), across_(drawn_at_once(format.format)) {
  check_layout(format);
  using shaders::image_format_pack_rgb, shaders::image_format_pack_table,
      shaders::image_format_pack_yuv;
  const Gamut& gamut = format.gamut;
  switch (kernel_of(format.format)) {
    case Kernel::rgb:
      across_ = 4;
      rgb_.emplace(device, with_gamut(rgb_constants<image_format_pack_rgb>(format), gamut));
      break;
    case Kernel::yuv:
      yuv_.emplace(device, with_gamut(yuv_constants<image_format_pack_yuv>(format), gamut));
      break;
    case Kernel::table: {
      auto constants = with_gamut(table_constants<image_format_pack_table>(format), gamut);
      constants.across = across_;
      table_.emplace(device, constants);
    }
  }
}

void Pack::record(gpu::Commands& commands, const Drawing& drawing,
                  const gpu::BufferPtr& raw) const {
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
                  .largest = luma.largest,
                  .first_row = 0};
  const gpu::BufferPtr &picture = drawing.picture.buffer,
                       &alpha = drawing.alpha ? drawing.alpha->buffer : picture;
  const gpu::Rows rows{blocks(format_.extent.width, across_), format_.extent.height, kStripRows};
  // Rows of several planes are not one part of a buffer.
  const gpu::Out to = format_.format.planes == 1 ? gpu::Out(gpu::by_rows(raw)) : gpu::Out(raw);
  if (rgb_)
    commands.dispatch_rows(*rgb_, {.picture = picture, .alpha_plane = alpha, .raw = to}, push,
                           rows);
  if (yuv_) commands.dispatch_rows(*yuv_, {.picture = picture, .raw = to}, push, rows);
  if (table_)
    commands.dispatch_rows(*table_, {.picture = picture, .alpha_plane = alpha, .raw = to}, push,
                           rows);
}

}  // namespace inverse
