// SPDX-License-Identifier: LGPL-2.1-or-later
#include "small_picture.hpp"

#include <algorithm>
#include <cstring>

namespace inverse::run {

SmallPictureMaker::~SmallPictureMaker() {
  if (converter_) gst_video_converter_free(converter_);
}

void SmallPictureMaker::configure(const GstVideoInfo& info) {
  if (converter_) gst_video_converter_free(converter_);
  from_ = info;
  if (!height_) {
    const double aspect =
        static_cast<double>(info.width) * info.par_n / (1.0 * info.height * info.par_d);
    height_ = std::clamp(static_cast<int>(width_ / aspect + 0.5), 1, 4 * width_);
  }
  gst_video_info_set_format(&to_, GST_VIDEO_FORMAT_RGB, width_, height_);
  to_.fps_n = from_.fps_n;  // required by the converter
  to_.fps_d = from_.fps_d;
  converter_ = gst_video_converter_new(&from_, &to_, nullptr);
}

SmallPicture SmallPictureMaker::make(GstBuffer* buffer, const GstCaps* caps) {
  GstVideoInfo info;
  if (!caps || !gst_video_info_from_caps(&info, caps)) return {};
  if (!converter_ || !gst_video_info_is_equal(&info, &from_)) configure(info);
  if (!converter_) return {};

  GstVideoFrame in, out;
  if (!gst_video_frame_map(&in, &info, buffer, GST_MAP_READ)) return {};
  GstBuffer* scaled = gst_buffer_new_allocate(nullptr, to_.size, nullptr);
  gst_video_frame_map(&out, &to_, scaled, GST_MAP_WRITE);
  gst_video_converter_frame(converter_, &in, &out);
  const size_t row = static_cast<size_t>(width_) * 3;
  SmallPicture picture{width_, height_, std::vector<uint8_t>(row * height_)};
  for (int y = 0; y < height_; ++y)
    memcpy(&picture.rgb[y * row],
           static_cast<uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&out, 0)) +
               static_cast<ptrdiff_t>(y) * GST_VIDEO_FRAME_PLANE_STRIDE(&out, 0),
           row);
  gst_video_frame_unmap(&out);
  gst_video_frame_unmap(&in);
  gst_buffer_unref(scaled);
  return picture;
}

}  // namespace inverse::run
