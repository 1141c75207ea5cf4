// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/video/video.h>

#include <opencv2/core.hpp>

#include "raw_frame.hpp"

namespace inverse {

/// A frame as an OpenCV picture of its code values, unpacked by GStreamer (CV_8UC4 or CV_16UC4).
/// Throws Error(unsupported) if the buffer does not fit its caps.
cv::Mat read_codes(const GstVideoInfo& info, GstBuffer* buffer);
/// Writes such a picture into a writable buffer.
void write_codes(const GstVideoInfo& info, GstBuffer* buffer, const cv::Mat& codes);
/// Their linear light, CV_32FC3 (red, green, blue).
cv::Mat linear_light(const Linearizer& linear, const cv::Mat& codes);

}  // namespace inverse
