// SPDX-License-Identifier: LGPL-2.1-or-later
// The editor that follows planes.
#include <gst/gst.h>

#include "gst/base/filter.hpp"
#include "gst/base/meta/layers_meta.hpp"

namespace inverse {
extern const ElementInfo kIntrinsicTexture;
}  // namespace inverse

static gboolean plugin_init(GstPlugin* plugin) {
  inverse::register_layers_meta();
  return inverse::register_filter(plugin, inverse::kIntrinsicTexture);
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, inversetexture,
                  "Pictures on planes of live video, lit as the scene is", plugin_init, VERSION,
                  "LGPL", "gst-inverse", "Unknown package origin")
