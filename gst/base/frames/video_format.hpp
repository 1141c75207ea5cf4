// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/video/video.h>

#include <span>
#include <string>

#include "kernels/image/format/pixel_format.hpp"

namespace inverse {

/// The formats of raw video that the kernels read and write, the preferred ones first.
std::span<const GstVideoFormat> color_formats();
std::span<const GstVideoFormat> gray_formats();

/// How the samples of one of them lie in memory, by GStreamer's own description. Throws
/// Error(unsupported), which names the nearest formats, for all others.
PixelFormat video_format(GstVideoFormat format);

/// Up to three of the formats above that lose least of what this one has, the nearest first, as
/// "A, B or C".
std::string nearest_formats(GstVideoFormat format);

}  // namespace inverse
