#pragma once
#include <gst/gst.h>

#include "inverse_light_stage_meta.h"

namespace inverse {

/// Adds a light stage meta to a buffer: all zero, step and light -1.
GstLightStageMeta* add_light_stage_meta(GstBuffer* buffer);

/// Registers the meta, so that its header works before the first frame.
void register_light_stage_meta();

}  // namespace inverse
