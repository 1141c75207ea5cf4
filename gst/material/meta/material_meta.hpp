// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include "gst/inverse/inverse_material_meta.h"

namespace inverse {

/// Adds a material meta, all zero, to a buffer.
GstMaterialMeta* add_material_meta(GstBuffer* buffer);

/// Registers the meta, so that its header works before the first frame.
void register_material_meta();

}  // namespace inverse
