// SPDX-License-Identifier: LGPL-2.1-or-later
// The element of this folder that is in the plugin inverse.
#include "gst/base/filter.hpp"
#include "gst/material/meta/material_meta.hpp"

namespace inverse {
extern const ElementInfo kLimeMaterial;
gboolean register_material(GstPlugin* plugin);

gboolean register_material(GstPlugin* plugin) {
  register_material_meta();
  return register_filter(plugin, kLimeMaterial);
}

}  // namespace inverse
