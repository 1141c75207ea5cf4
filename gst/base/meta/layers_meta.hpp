// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include "gst/inverse/inverse_layers_meta.h"
#include "kernels/image/layers.hpp"

namespace inverse {

/// Attaches layers to a buffer; the meta holds its own references to the planes.
void attach_layers(GstBuffer* buffer, const Layers& layers);

/// The layers of a buffer, or null if it carries none of a plugin of this build.
const Layers* layers_of(GstBuffer* buffer);

/// The layers of a buffer for which `layers_of` is not null. If nothing else holds the buffer they
/// are moved out of it, so that their only holder can work in place.
Layers take_layers(GstBuffer* buffer);

/// Registers the meta, so that its header works before the first frame.
void register_layers_meta();

}  // namespace inverse
