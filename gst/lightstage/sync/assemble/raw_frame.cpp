// SPDX-License-Identifier: LGPL-2.1-or-later
#include "raw_frame.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "common/error.hpp"

namespace inverse {
namespace {

constexpr uint32_t kGrid = 48;  // rows and columns of samples
constexpr size_t kCurveSteps = 4096;
constexpr float kClipped = 0.97F;  // of full scale

/// Whether all rows of the frame are in its mapped memory: GStreamer only checks the first byte if
/// a GstVideoMeta gives the offsets.
bool is_whole(const GstVideoInfo& info, const GstVideoFrame& frame) {
  const GstVideoFormatInfo* format = frame.info.finfo;
  // Strides of tiled formats count tiles; all are there if the bytes are.
  if (GST_VIDEO_FORMAT_INFO_IS_TILED(format))
    return gst_buffer_get_size(frame.buffer) >= GST_VIDEO_INFO_SIZE(&frame.info);
  for (guint plane = 0; plane < GST_VIDEO_FORMAT_INFO_N_PLANES(format); ++plane) {
    const GstMapInfo& map = frame.map[frame.meta ? plane : 0];
    const auto* begin = static_cast<const guint8*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, plane));
    if (!map.data || begin < map.data || begin >= map.data + map.size) return frame.meta != nullptr;
    gint components[GST_VIDEO_MAX_COMPONENTS];
    gst_video_format_info_component(format, plane, components);
    const gint rows = GST_VIDEO_FRAME_COMP_HEIGHT(&frame, components[0]);
    gint64 row = gint64{GST_VIDEO_FRAME_COMP_WIDTH(&frame, components[0])} *
                 GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, components[0]);
    if (row == 0) row = GST_VIDEO_INFO_PLANE_STRIDE(&info, plane);  // several samples a word
    const gint64 last = gint64{GST_VIDEO_FRAME_PLANE_STRIDE(&frame, plane)} * (rows - 1);
    const gint64 start = begin - map.data;
    if (start + std::min<gint64>(last, 0) < 0 ||
        start + std::max<gint64>(last, 0) + row > static_cast<gint64>(map.size))
      return false;
  }
  return true;
}

bool suits(const GstVideoInfo& info, GstBuffer* buffer) {
  const GstVideoMeta* meta = gst_buffer_get_video_meta(buffer);
  return !meta || (meta->format == GST_VIDEO_INFO_FORMAT(&info) &&
                   meta->width >= static_cast<guint>(GST_VIDEO_INFO_WIDTH(&info)) &&
                   meta->height >= static_cast<guint>(GST_VIDEO_INFO_HEIGHT(&info)));
}

}  // namespace

RawFrame::RawFrame(const GstVideoInfo& info, GstBuffer* buffer, GstMapFlags flags)
    : info_(info), unpacked_(gst_video_format_get_info(info.finfo->unpack_format)) {
  const auto no_ref = static_cast<GstMapFlags>(static_cast<int>(flags) |
                                               static_cast<int>(GST_VIDEO_FRAME_MAP_FLAG_NO_REF));
  bool good = suits(info, buffer) && gst_video_frame_map(&frame_, &info, buffer, no_ref);
  if (good && !is_whole(info, frame_)) {
    gst_video_frame_unmap(&frame_);
    good = false;
  }
  if (!good)
    throw Error(ErrorKind::unsupported,
                "a buffer of " + std::to_string(gst_buffer_get_size(buffer)) +
                    " bytes cannot hold the " + std::to_string(GST_VIDEO_INFO_WIDTH(&info)) + "x" +
                    std::to_string(GST_VIDEO_INFO_HEIGHT(&info)) + " " +
                    gst_video_format_to_string(GST_VIDEO_INFO_FORMAT(&info)) +
                    " frame of its caps; fix the element that sent it");
}

RawFrame::~RawFrame() { gst_video_frame_unmap(&frame_); }

void RawFrame::unpack(uint32_t row, void* to) const {
  info_.finfo->unpack_func(info_.finfo, GST_VIDEO_PACK_FLAG_NONE, to, frame_.data,
                           frame_.info.stride, 0, static_cast<gint>(row),
                           static_cast<gint>(width()));
}

void RawFrame::pack(uint32_t row, void* from) {
  info_.finfo->pack_func(info_.finfo, GST_VIDEO_PACK_FLAG_NONE, from, 0, frame_.data,
                         frame_.info.stride, info_.chroma_site, static_cast<gint>(row),
                         static_cast<gint>(width()));
}

Linearizer::Linearizer(const GstVideoInfo& info)
    : yuv_(GST_VIDEO_FORMAT_INFO_IS_YUV(info.finfo) || GST_VIDEO_FORMAT_INFO_IS_GRAY(info.finfo)),
      curve_(kCurveSteps + 1) {
  GstVideoTransferFunction transfer = info.colorimetry.transfer;
  if (transfer == GST_VIDEO_TRANSFER_UNKNOWN) transfer = GST_VIDEO_TRANSFER_SRGB;
  for (size_t i = 0; i <= kCurveSteps; ++i)
    curve_[i] = static_cast<float>(
        gst_video_transfer_function_decode(transfer, static_cast<double>(i) / kCurveSteps));
  if (!yuv_) return;
  GstVideoColorMatrix matrix = info.colorimetry.matrix;
  if (matrix == GST_VIDEO_COLOR_MATRIX_RGB || matrix == GST_VIDEO_COLOR_MATRIX_UNKNOWN)
    matrix = GST_VIDEO_COLOR_MATRIX_BT601;
  gst_video_color_matrix_get_Kr_Kb(matrix, &kr_, &kb_);
  GstVideoColorRange range = info.colorimetry.range;
  const bool gray = GST_VIDEO_FORMAT_INFO_IS_GRAY(info.finfo);
  if (range == GST_VIDEO_COLOR_RANGE_UNKNOWN)
    range = gray ? GST_VIDEO_COLOR_RANGE_0_255 : GST_VIDEO_COLOR_RANGE_16_235;
  const bool limited = range == GST_VIDEO_COLOR_RANGE_16_235;
  luma_offset_ = limited ? 16.0 / 255 : 0;
  luma_scale_ = limited ? 255.0 / 219 : 1;
  chroma_offset_ = 128.0 / 255;
  chroma_scale_ = gray ? 0 : limited ? 255.0 / 224 : 1;
}

float Linearizer::curve(double code) const {
  const double at = std::clamp(code, 0.0, 1.0) * kCurveSteps;
  const auto below = std::min(static_cast<size_t>(at), kCurveSteps - 1);
  const auto share = static_cast<float>(at - static_cast<double>(below));
  return curve_[below] * (1 - share) + curve_[below + 1] * share;
}

template <typename T>
void Linearizer::convert(const T* samples, double unit, float* rgb) const {
  const double a = samples[1] * unit, b = samples[2] * unit, c = samples[3] * unit;
  if (!yuv_) {
    rgb[0] = curve(a);
    rgb[1] = curve(b);
    rgb[2] = curve(c);
    return;
  }
  const double y = (a - luma_offset_) * luma_scale_;
  const double u = (b - chroma_offset_) * chroma_scale_, v = (c - chroma_offset_) * chroma_scale_;
  const double red = y + 2 * (1 - kr_) * v, blue = y + 2 * (1 - kb_) * u;
  const double green = (y - kr_ * red - kb_ * blue) / (1 - kr_ - kb_);
  rgb[0] = curve(red);
  rgb[1] = curve(green);
  rgb[2] = curve(blue);
}

void Linearizer::operator()(const uint8_t* samples, float* rgb) const {
  convert(samples, 1.0 / 255, rgb);
}

void Linearizer::operator()(const uint16_t* samples, float* rgb) const {
  convert(samples, 1.0 / 65535, rgb);
}

ImageEvidence image_evidence(const GstVideoInfo& info, const Linearizer& linear,
                             GstBuffer* buffer) {
  const RawFrame frame(info, buffer, GST_MAP_READ);
  const uint32_t rows = std::min(kGrid, frame.height()), columns = std::min(kGrid, frame.width());
  std::vector<uint64_t> row((frame.row_bytes() + 7) / 8);
  ImageEvidence seen;
  uint64_t hash = 14695981039346656037U, clipped = 0;
  for (uint32_t r = 0; r < rows; ++r) {
    frame.unpack((2 * r + 1) * frame.height() / (2 * rows), row.data());
    for (const uint64_t word : row) hash = (hash ^ word) * 1099511628211U;
    for (uint32_t c = 0; c < columns; ++c) {
      const size_t at = size_t{4} * ((2 * c + 1) * frame.width() / (2 * columns));
      float rgb[3];
      if (frame.wide())
        linear(reinterpret_cast<const uint16_t*>(row.data()) + at, rgb);
      else
        linear(reinterpret_cast<const uint8_t*>(row.data()) + at, rgb);
      for (size_t k = 0; k < 3; ++k) seen.level[k] += static_cast<double>(rgb[k]);
      clipped += std::max({rgb[0], rgb[1], rgb[2]}) > kClipped ? 1 : 0;
    }
  }
  const double count = static_cast<double>(rows) * columns;
  for (double& level : seen.level) level /= count;
  seen.clipped = static_cast<double>(clipped) / count;
  seen.content = hash | 1;
  return seen;
}

}  // namespace inverse
