// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/video/video.h>

#include <cstdint>
#include <vector>

#include "kernels/lightstage/labels/light_evidence.hpp"

namespace inverse {

/// A frame of any raw format in system memory, mapped for as long as this lives, row by row as
/// GStreamer unpacks it: four samples a pixel, alpha first, of 8 or 16 bits.
class RawFrame {
 public:
  /// Throws Error(unsupported) if the buffer does not fit its caps.
  RawFrame(const GstVideoInfo& info, GstBuffer* buffer, GstMapFlags flags);
  RawFrame(const RawFrame&) = delete;
  RawFrame& operator=(const RawFrame&) = delete;
  ~RawFrame();

  uint32_t width() const { return static_cast<uint32_t>(GST_VIDEO_INFO_WIDTH(&info_)); }
  uint32_t height() const { return static_cast<uint32_t>(GST_VIDEO_INFO_HEIGHT(&info_)); }
  /// Whether samples have 16 bits.
  bool wide() const { return unpacked_->bits > 8; }
  size_t row_bytes() const { return size_t{width()} * (wide() ? 8 : 4); }
  void unpack(uint32_t row, void* to) const;
  /// Writes a row; rows must come from the top down.
  void pack(uint32_t row, void* from);
  GstVideoFrame* frame() { return &frame_; }

 private:
  GstVideoInfo info_;
  GstVideoFrame frame_;
  const GstVideoFormatInfo* unpacked_;
};

/// Converts unpacked values of RawFrame to linear light, 1 = full scale; clips beyond the nominal
/// range.
class Linearizer {
 public:
  explicit Linearizer(const GstVideoInfo& info);
  /// Linear RGB of the pixel at `samples` (of 8 or 16 bits, as unpacked).
  void operator()(const uint8_t* samples, float* rgb) const;
  void operator()(const uint16_t* samples, float* rgb) const;

 private:
  template <typename T>
  void convert(const T* samples, double unit, float* rgb) const;
  float curve(double code) const;

  bool yuv_;
  std::vector<float> curve_;
  double luma_offset_ = 0, luma_scale_ = 1, chroma_offset_ = 0.5, chroma_scale_ = 1;
  double kr_ = 0.2126, kb_ = 0.0722;
};

/// Features of a frame for labeling: its mean light, on a grid, and a fingerprint.
ImageEvidence image_evidence(const GstVideoInfo& info, const Linearizer& linear, GstBuffer* buffer);

}  // namespace inverse
