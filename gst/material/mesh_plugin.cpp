// SPDX-License-Identifier: LGPL-2.1-or-later
// The elements that draw meshes, nothing else.
#include "gst/base/filter.hpp"
#include "gst/base/meta/layers_meta.hpp"

namespace inverse {
extern const ElementInfo kMaterialClone;
}  // namespace inverse

static gboolean plugin_init(GstPlugin* plugin) {
  inverse::register_layers_meta();
  return inverse::register_filter(plugin, inverse::kMaterialClone);
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, inversemesh,
                  "Draws meshes into live video, with an estimated material", plugin_init, VERSION,
                  "LGPL", "gst-inverse", "Unknown package origin")
