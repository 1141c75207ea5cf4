#include "convert.hpp"

#include <algorithm>
#include <string>

#include "common/error.hpp"
#include "kernels/gpu/shaders.hpp"

INVERSE_SHADER(image_format_unpack_rgb);
INVERSE_SHADER(image_format_unpack_yuv);
INVERSE_SHADER(image_format_pack_rgb);
INVERSE_SHADER(image_format_pack_yuv);

namespace inverse {
namespace {

/// frame.glsl's push constants.
struct Push {
  uint32_t size[2];
  uint32_t words, flags;
  uint32_t offset[4], stride[4];
  float codes[4], matrix[4], curve[4];
  float power, ceiling, gain, largest;
};
constexpr uint32_t kFlagShading = 1, kFlagOpaque = 2;
constexpr uint32_t kStripRows = 8;  // rows per invocation, in every kernel
constexpr uint32_t kStrips = TileList::kTile / kStripRows;

Push layout_push(const FrameFormat& format) {
  Push push{};
  push.size[0] = format.extent.width;
  push.size[1] = format.extent.height;
  push.words = static_cast<uint32_t>(raw_words(format));
  for (uint32_t p = 0; p < plane_count(format.format); ++p) {
    push.offset[p] = format.offset[p] / 4;
    push.stride[p] = format.stride[p] / 4;
  }
  return push;
}

double largest_value(const CodeScale& codes) {
  return (codes.largest - codes.offset) / codes.scale;
}

/// Specialization constants of the RGB and gray kernels.
std::vector<uint32_t> rgb_constants(const FrameFormat& format) {
  const bool bgr = format.format == PixelFormat::bgra || format.format == PixelFormat::bgrx ||
                   format.format == PixelFormat::bgr;
  const uint32_t pixel = row_bytes(format.format, {1, 1}, 0);
  return {!format.transfer.is_linear(), pixel, bgr, has_alpha(format.format)};
}

/// Specialization constants of the Y'CbCr kernels (yuv.glsl).
std::vector<uint32_t> yuv_constants(const FrameFormat& format) {
  uint32_t layout = 0;
  if (plane_count(format.format) == 3) layout = 1;
  if (format.format == PixelFormat::yuy2) layout = 2;
  if (format.format == PixelFormat::uyvy) layout = 3;
  const bool deep = bit_depth(format.format) > 8;
  const uint32_t shift = format.format == PixelFormat::p010_10le ? 6 : 0;
  return {!format.transfer.is_linear(), layout, deep, shift, format.site.cosited_x,
          format.site.cosited_y};
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
  kernel_ =
      is_yuv(format.format)
          ? TileKernel(device, shaders::image_format_unpack_yuv, yuv_constants(format), 4, kStrips)
          : TileKernel(device, shaders::image_format_unpack_rgb, rgb_constants(format), 4, kStrips);
}

void Unpack::record(gpu::Commands& commands, const gpu::BufferPtr& raw, const Plane& linear,
                    const TileList* listed) const {
  check_planes(format_, raw, &linear);
  Push push = layout_push(format_);
  const CodeScale luma = luma_codes(format_), chroma = chroma_codes(format_);
  push.codes[0] = luma.offset;
  push.codes[1] = 1 / luma.scale;
  push.codes[2] = chroma.offset;
  push.codes[3] = 1 / chroma.scale;
  const double kr = format_.matrix.kr, kb = format_.matrix.kb, kg = 1 - kr - kb;
  push.matrix[0] = static_cast<float>(2 * (1 - kr));
  push.matrix[1] = static_cast<float>(-2 * (1 - kb) * kb / kg);
  push.matrix[2] = static_cast<float>(-2 * (1 - kr) * kr / kg);
  push.matrix[3] = static_cast<float>(2 * (1 - kb));
  const Transfer& t = format_.transfer;
  push.curve[0] = t.start;
  push.curve[1] = t.slope;
  push.curve[2] = t.scale;
  push.curve[3] = t.offset;
  push.power = t.power;
  push.ceiling = static_cast<float>(largest_value(luma));
  kernel_.dispatch(commands, listed, {raw, linear.buffer}, push,
                   {blocks(format_.extent.width, 4), blocks(format_.extent.height, kStripRows)});
}

Pack::Pack(const std::shared_ptr<gpu::Device>& device, const FrameFormat& format)
    : format_(format) {
  check_layout(format);
  kernel_ =
      is_yuv(format.format)
          ? TileKernel(device, shaders::image_format_pack_yuv, yuv_constants(format),
                       TileList::kTile / drawn_at_once(format), kStrips)
          : TileKernel(device, shaders::image_format_pack_rgb, rgb_constants(format), 4, kStrips);
}

void Pack::record(gpu::Commands& commands, const Drawing& drawing, const gpu::BufferPtr& raw,
                  const TileList* listed) const {
  check_planes(format_, raw, &drawing.picture);
  check_planes(format_, raw, drawing.alpha);
  Push push = layout_push(format_);
  if (drawing.source == Drawing::Source::shading) push.flags |= kFlagShading;
  if (!drawing.alpha) push.flags |= kFlagOpaque;
  const CodeScale luma = luma_codes(format_), chroma = chroma_codes(format_);
  push.codes[0] = luma.offset;
  push.codes[1] = luma.scale;
  push.codes[2] = chroma.offset;
  push.codes[3] = chroma.scale;
  push.largest = luma.largest;
  const Matrix matrix = format_.matrix.is_identity() ? Matrix::bt709() : format_.matrix;
  push.matrix[0] = matrix.kr;
  push.matrix[1] = matrix.kb;
  push.matrix[2] = 0.5f / (1 - matrix.kb);
  push.matrix[3] = 0.5f / (1 - matrix.kr);
  const Transfer& t = format_.transfer;
  push.curve[0] = static_cast<float>(t.linear_start());
  push.curve[1] = 1 / t.slope;
  push.curve[2] = 1 / t.scale;
  push.curve[3] = -t.offset / t.scale;
  push.power = 1 / t.power;
  push.ceiling = static_cast<float>(t.decode(largest_value(luma)));
  push.gain = drawing.gain;

  const Extent extent = format_.extent;
  const gpu::BufferPtr& picture = drawing.picture.buffer;
  if (!is_yuv(format_.format)) {
    kernel_.dispatch(commands, listed,
                     {picture, drawing.alpha ? drawing.alpha->buffer : picture, raw}, push,
                     {blocks(extent.width, 4), blocks(extent.height, kStripRows)});
    return;
  }
  kernel_.dispatch(
      commands, listed, {picture, raw}, push,
      {blocks(extent.width, drawn_at_once(format_)), blocks(extent.height, kStripRows)});
}

}  // namespace inverse
