// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include "gst/depth/calibration.hpp"
#include "gst/inverse/inverse_depth_meta.h"

namespace inverse {

/// Adds a depth meta to a buffer: all zero. The caller gives it a reference of `depth`.
GstInverseDepthMeta* add_depth_meta(GstBuffer* buffer);

/// Adds one of an image without padding, with the lens that took it; takes over `image`.
GstInverseDepthMeta* add_depth_meta(GstBuffer* buffer, GstBuffer* image, double unit,
                                    const CalibratedCamera& lens);

/// Registers the meta, so that its header works before the first frame.
void register_depth_meta();

}  // namespace inverse
