#pragma once
#include <gst/gst.h>

#include "image/layers.hpp"
#include "inverse_layers_meta.h"

namespace inverse {

/// Attaches layers to a buffer; the meta holds its own references to the planes.
void attach_layers(GstBuffer* buffer, const Layers& layers);

/// The layers of a buffer, or null where it carries none.
const Layers* layers_of(GstBuffer* buffer);

/// Registers the meta, so that its header works before the first frame.
void register_layers_meta();

}  // namespace inverse
