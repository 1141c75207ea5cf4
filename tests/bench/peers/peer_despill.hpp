// SPDX-License-Identifier: LGPL-2.1-or-later
// Other despill methods, pixel by pixel. Images are linear; the formulas use display codes (sRGB).
#pragma once

#include "tests/bench/metrics/image.hpp"

namespace inverse::bench {

/// FFmpeg's filter despill, type=green, as it is by default (libavfilter/vf_despill.c: mix .5,
/// expand 0, green −1, red, blue and brightness 0): G − max(G − (R + B)/2, 0).
Image ffmpeg_despill(const Image& linear);

/// Green no more than the larger of red and blue (Vlahos' limit; R. Brinkmann, The Art and Science
/// of Digital Compositing, 2nd edition, 2008, Spill suppression).
Image green_limit(const Image& linear);

/// What GStreamer's element alpha leaves of colors with method=green (gst-plugins-good,
/// gst/alpha/gstalpha.c, after Jack, Video Demystified), alpha aside: in the plane of chroma turned
/// to the key's, what lies within the angle (20°) of it moves to the angle's edge along the key,
/// and gets darker by the same share of the key's luma. BT.601, full range.
Image gst_alpha_green(const Image& linear);

}  // namespace inverse::bench
