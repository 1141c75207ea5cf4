// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/video/video.h>

#include <cstdint>
#include <vector>

namespace inverse::run {

/// Packed 8-bit RGB of `width` × `height` pixels, no padding; may be empty.
struct SmallPicture {
  int width = 0, height = 0;
  std::vector<uint8_t> rgb;
};

/// Scales frames of raw video to RGB of fixed width; the height follows the first frame's shape,
/// even if the shape changes later.
class SmallPictureMaker {
 public:
  explicit SmallPictureMaker(int width) : width_(width) {}
  SmallPictureMaker(const SmallPictureMaker&) = delete;
  SmallPictureMaker& operator=(const SmallPictureMaker&) = delete;
  ~SmallPictureMaker();

  /// `caps` are of raw video in system memory. Empty if the frame cannot be read.
  SmallPicture make(GstBuffer* buffer, const GstCaps* caps);

  int width() const { return width_; }
  int height() const { return height_; }  ///< 0 before the first picture
  const GstVideoColorimetry& colorimetry() const { return from_.colorimetry; }  ///< of the video

 private:
  void configure(const GstVideoInfo& info);

  const int width_;
  int height_ = 0;
  GstVideoInfo from_{}, to_{};
  GstVideoConverter* converter_ = nullptr;
};

}  // namespace inverse::run
