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

/// That of the candidates which loses least of what a format has, the worst first: color, depth,
/// chroma samples, alpha; the first of equals. Unknown if there are none.
GstVideoFormat nearest_format(GstVideoFormat format, std::span<const GstVideoFormat> candidates);

/// The three of the formats above that are nearest in this sense, as "A, B or C".
std::string nearest_formats(GstVideoFormat format);

}  // namespace inverse
