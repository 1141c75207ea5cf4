// SPDX-License-Identifier: LGPL-2.1-or-later
#include "video_format.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <tuple>
#include <vector>

#include "common/error.hpp"

namespace inverse {
namespace {

// Packed RGB of 8 bits needs the least work; the formats after RGBA64_LE have no kernel of their
// own.
constexpr GstVideoFormat kColor[] = {
    GST_VIDEO_FORMAT_RGBA,        GST_VIDEO_FORMAT_BGRA,      GST_VIDEO_FORMAT_RGBx,
    GST_VIDEO_FORMAT_BGRx,        GST_VIDEO_FORMAT_NV12,      GST_VIDEO_FORMAT_I420,
    GST_VIDEO_FORMAT_YUY2,        GST_VIDEO_FORMAT_UYVY,      GST_VIDEO_FORMAT_RGB,
    GST_VIDEO_FORMAT_BGR,         GST_VIDEO_FORMAT_P010_10LE, GST_VIDEO_FORMAT_I420_10LE,
    GST_VIDEO_FORMAT_RGBA64_LE,   GST_VIDEO_FORMAT_ARGB,      GST_VIDEO_FORMAT_ABGR,
    GST_VIDEO_FORMAT_xRGB,        GST_VIDEO_FORMAT_xBGR,      GST_VIDEO_FORMAT_NV21,
    GST_VIDEO_FORMAT_YV12,        GST_VIDEO_FORMAT_NV16,      GST_VIDEO_FORMAT_NV61,
    GST_VIDEO_FORMAT_Y42B,        GST_VIDEO_FORMAT_YVYU,      GST_VIDEO_FORMAT_VYUY,
    GST_VIDEO_FORMAT_NV24,        GST_VIDEO_FORMAT_Y444,      GST_VIDEO_FORMAT_AYUV,
    GST_VIDEO_FORMAT_VUYA,        GST_VIDEO_FORMAT_v308,      GST_VIDEO_FORMAT_IYU2,
    GST_VIDEO_FORMAT_Y41B,        GST_VIDEO_FORMAT_AV12,      GST_VIDEO_FORMAT_A420,
    GST_VIDEO_FORMAT_GBR,         GST_VIDEO_FORMAT_GBRA,      GST_VIDEO_FORMAT_RGBP,
    GST_VIDEO_FORMAT_BGRP,        GST_VIDEO_FORMAT_RGB16,     GST_VIDEO_FORMAT_BGR16,
    GST_VIDEO_FORMAT_RGB15,       GST_VIDEO_FORMAT_BGR15,     GST_VIDEO_FORMAT_BGR10A2_LE,
    GST_VIDEO_FORMAT_RGB10A2_LE,  GST_VIDEO_FORMAT_r210,      GST_VIDEO_FORMAT_Y210,
    GST_VIDEO_FORMAT_v210,        GST_VIDEO_FORMAT_Y410,      GST_VIDEO_FORMAT_NV12_10LE32,
    GST_VIDEO_FORMAT_NV16_10LE32, GST_VIDEO_FORMAT_I422_10LE, GST_VIDEO_FORMAT_Y444_10LE,
    GST_VIDEO_FORMAT_A420_10LE,   GST_VIDEO_FORMAT_A422_10LE, GST_VIDEO_FORMAT_A444_10LE,
    GST_VIDEO_FORMAT_GBR_10LE,    GST_VIDEO_FORMAT_GBRA_10LE, GST_VIDEO_FORMAT_P012_LE,
    GST_VIDEO_FORMAT_I420_12LE,   GST_VIDEO_FORMAT_Y212_LE,   GST_VIDEO_FORMAT_I422_12LE,
    GST_VIDEO_FORMAT_Y412_LE,     GST_VIDEO_FORMAT_Y444_12LE, GST_VIDEO_FORMAT_GBR_12LE,
    GST_VIDEO_FORMAT_GBRA_12LE,   GST_VIDEO_FORMAT_P016_LE,   GST_VIDEO_FORMAT_v216,
    GST_VIDEO_FORMAT_Y444_16LE,   GST_VIDEO_FORMAT_AYUV64,    GST_VIDEO_FORMAT_ARGB64,
    GST_VIDEO_FORMAT_ARGB64_LE,   GST_VIDEO_FORMAT_BGRA64_LE, GST_VIDEO_FORMAT_ABGR64_LE,
    GST_VIDEO_FORMAT_RGBA64_BE,   GST_VIDEO_FORMAT_ARGB64_BE, GST_VIDEO_FORMAT_BGRA64_BE,
    GST_VIDEO_FORMAT_ABGR64_BE,   GST_VIDEO_FORMAT_P010_10BE, GST_VIDEO_FORMAT_I420_10BE,
    GST_VIDEO_FORMAT_I422_10BE,   GST_VIDEO_FORMAT_Y444_10BE, GST_VIDEO_FORMAT_A420_10BE,
    GST_VIDEO_FORMAT_A422_10BE,   GST_VIDEO_FORMAT_A444_10BE, GST_VIDEO_FORMAT_GBR_10BE,
    GST_VIDEO_FORMAT_GBRA_10BE,   GST_VIDEO_FORMAT_P012_BE,   GST_VIDEO_FORMAT_I420_12BE,
    GST_VIDEO_FORMAT_Y212_BE,     GST_VIDEO_FORMAT_I422_12BE, GST_VIDEO_FORMAT_Y412_BE,
    GST_VIDEO_FORMAT_Y444_12BE,   GST_VIDEO_FORMAT_GBR_12BE,  GST_VIDEO_FORMAT_GBRA_12BE,
    GST_VIDEO_FORMAT_P016_BE,     GST_VIDEO_FORMAT_Y444_16BE};
constexpr GstVideoFormat kGray[] = {GST_VIDEO_FORMAT_GRAY8, GST_VIDEO_FORMAT_GRAY16_LE,
                                    GST_VIDEO_FORMAT_GRAY16_BE, GST_VIDEO_FORMAT_GRAY10_LE32};

/// What GStreamer 1.22 leaves out of its descriptions, or describes otherwise than its own
/// functions read it.
void correct(PixelFormat& f, GstVideoFormat format) {
  Component &y = f.components[0], &u = f.components[1], &v = f.components[2], &a = f.components[3];
  const auto offsets = [&](uint8_t first, uint8_t second, uint8_t third) {
    y.offset = first;
    u.offset = second;
    v.offset = third;
  };
  const auto shifts = [&](uint8_t first, uint8_t second, uint8_t third, uint8_t fourth) {
    y.shift = first;
    u.shift = second;
    v.shift = third;
    a.shift = fourth;
  };
  const auto thirds = [&](uint8_t luma, uint8_t chroma) {
    f.unit = Unit::thirds;
    y.stride = luma;
    u.stride = v.stride = chroma;
  };
  switch (format) {
    case GST_VIDEO_FORMAT_v210:  // the samples of UYVY
      thirds(2, 4);
      return offsets(1, 0, 2);
    case GST_VIDEO_FORMAT_GRAY10_LE32:
      return thirds(1, 0);
    case GST_VIDEO_FORMAT_NV12_10LE32:
    case GST_VIDEO_FORMAT_NV16_10LE32:
      return thirds(1, 2);
    case GST_VIDEO_FORMAT_Y210:
      f.unit = Unit::le16;
      shifts(6, 6, 6, 0);
      return offsets(0, 2, 6);
    case GST_VIDEO_FORMAT_Y212_LE:
    case GST_VIDEO_FORMAT_Y212_BE:
      return offsets(0, 2, 6);
    case GST_VIDEO_FORMAT_Y412_LE:
    case GST_VIDEO_FORMAT_Y412_BE:  // U Y V A
      a.offset = 6;
      return offsets(2, 0, 4);
    case GST_VIDEO_FORMAT_Y410:
      f.unit = Unit::le32;
      return shifts(10, 0, 20, 30);
    case GST_VIDEO_FORMAT_BGR10A2_LE:
      f.unit = Unit::le32;
      return shifts(20, 10, 0, 30);
    case GST_VIDEO_FORMAT_RGB10A2_LE:
      f.unit = Unit::le32;
      return shifts(0, 10, 20, 30);
    case GST_VIDEO_FORMAT_r210:
      f.unit = Unit::be32;
      return shifts(20, 10, 0, 0);
    case GST_VIDEO_FORMAT_v216:
      f.unit = Unit::le16;
      return;
    case GST_VIDEO_FORMAT_BGR16:
    case GST_VIDEO_FORMAT_BGR15:
      return std::swap(y.shift, v.shift);
    case GST_VIDEO_FORMAT_VYUY:
      return offsets(1, 2, 0);
    case GST_VIDEO_FORMAT_P010_10LE:
    case GST_VIDEO_FORMAT_P010_10BE:
    case GST_VIDEO_FORMAT_P012_LE:
    case GST_VIDEO_FORMAT_P012_BE:
    case GST_VIDEO_FORMAT_P016_LE:
    case GST_VIDEO_FORMAT_P016_BE:  // counted in samples
      v.offset = 2;
      return;
    default:
      return;
  }
}

PixelFormat described(const GstVideoFormatInfo& info) {
  PixelFormat f;
  f.name = info.name;
  f.model = GST_VIDEO_FORMAT_INFO_IS_YUV(&info)   ? PixelFormat::Model::yuv
            : GST_VIDEO_FORMAT_INFO_IS_RGB(&info) ? PixelFormat::Model::rgb
                                                  : PixelFormat::Model::gray;
  f.planes = static_cast<uint8_t>(info.n_planes);
  f.alpha = info.n_components == 4;
  bool wide = false;  // samples of 16 bits
  for (guint c = 0; c < info.n_components; ++c) {
    f.components[c] = {static_cast<uint8_t>(info.plane[c]), static_cast<uint8_t>(info.poffset[c]),
                       static_cast<uint8_t>(info.pixel_stride[c]),
                       static_cast<uint8_t>(info.shift[c]), static_cast<uint8_t>(info.depth[c])};
    wide |= info.depth[c] > 8 || info.shift[c] > 0;
  }
  if (wide) f.unit = GST_VIDEO_FORMAT_INFO_IS_LE(&info) ? Unit::le16 : Unit::be16;
  if (f.model == PixelFormat::Model::yuv) {
    f.w_sub = static_cast<uint8_t>(info.w_sub[1]);
    f.h_sub = static_cast<uint8_t>(info.h_sub[1]);
  }
  // The byte of RGBx and the like that no component lies in.
  if (f.model == PixelFormat::Model::rgb && info.n_components == 3 && !wide &&
      info.pixel_stride[0] == 4)
    f.components[3] = {
        0, static_cast<uint8_t>(6 - info.poffset[0] - info.poffset[1] - info.poffset[2]), 4, 0, 8};
  correct(f, info.format);
  return f;
}

bool is_listed(std::span<const GstVideoFormat> formats, GstVideoFormat format) {
  return std::find(formats.begin(), formats.end(), format) != formats.end();
}

/// What is lost from one format to another, the worst first; then how much they differ otherwise.
auto loss(const GstVideoFormatInfo& from, const GstVideoFormatInfo& to) {
  const bool color = GST_VIDEO_FORMAT_INFO_IS_GRAY(&to) && !GST_VIDEO_FORMAT_INFO_IS_GRAY(&from);
  const guint want = std::min(GST_VIDEO_FORMAT_INFO_DEPTH(&from, 0), 16U),
              depth = GST_VIDEO_FORMAT_INFO_DEPTH(&to, 0);
  const auto samples = [](const GstVideoFormatInfo& info) {
    return info.n_components < 3 ? 0 : static_cast<int>(info.w_sub[1] + info.h_sub[1]);
  };
  const int blur = samples(to) - samples(from);
  const bool alpha =
      GST_VIDEO_FORMAT_INFO_HAS_ALPHA(&from) && !GST_VIDEO_FORMAT_INFO_HAS_ALPHA(&to);
  const bool model = GST_VIDEO_FORMAT_INFO_IS_YUV(&from) != GST_VIDEO_FORMAT_INFO_IS_YUV(&to);
  return std::tuple{color,
                    want - std::min(depth, want),
                    std::max(blur, 0),
                    alpha,
                    model,
                    depth - std::min(want, depth),
                    std::abs(blur),
                    std::abs(static_cast<int>(to.n_planes - from.n_planes))};
}

}  // namespace

std::span<const GstVideoFormat> color_formats() { return kColor; }
std::span<const GstVideoFormat> gray_formats() { return kGray; }

PixelFormat video_format(GstVideoFormat format) {
  if (!is_listed(kColor, format) && !is_listed(kGray, format))
    throw Error(ErrorKind::unsupported, std::string("video format ") +
                                            gst_video_format_to_string(format) +
                                            " is not supported; insert videoconvert, which makes " +
                                            nearest_formats(format) + " of it");
  return described(*gst_video_format_get_info(format));
}

GstVideoFormat nearest_format(GstVideoFormat format, std::span<const GstVideoFormat> candidates) {
  const GstVideoFormatInfo& from = *gst_video_format_get_info(format);
  const auto nearest = std::min_element(candidates.begin(), candidates.end(),
                                        [&](GstVideoFormat a, GstVideoFormat b) {
                                          return loss(from, *gst_video_format_get_info(a)) <
                                                 loss(from, *gst_video_format_get_info(b));
                                        });
  return nearest == candidates.end() ? GST_VIDEO_FORMAT_UNKNOWN : *nearest;
}

std::string nearest_formats(GstVideoFormat format) {
  std::vector<GstVideoFormat> formats(std::begin(kColor), std::end(kColor));
  formats.insert(formats.end(), std::begin(kGray), std::end(kGray));
  std::string names;
  for (const char* before : {"", ", ", " or "}) {
    const GstVideoFormat nearest = nearest_format(format, formats);
    std::erase(formats, nearest);
    names += std::string(before) + gst_video_format_to_string(nearest);
  }
  return names;
}

}  // namespace inverse
