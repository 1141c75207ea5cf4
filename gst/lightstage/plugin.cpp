// SPDX-License-Identifier: LGPL-2.1-or-later
// The elements of light stages.
#include <gst/gst.h>

#include "gst/base/filter.hpp"
#include "gst/base/meta/layers_meta.hpp"
#include "gst/lightstage/meta/light_stage_meta.hpp"

namespace inverse {
extern const ElementInfo kOlatRelight;
gboolean register_lightstagesync(GstPlugin* plugin);
gboolean register_lightstagetestsrc(GstPlugin* plugin);
#if HAVE_ARAVIS
gboolean register_lightstagearavissrc(GstPlugin* plugin);
#endif
}  // namespace inverse

static gboolean plugin_init(GstPlugin* plugin) {
  inverse::register_layers_meta();
  inverse::register_light_stage_meta();
  gboolean all = inverse::register_lightstagesync(plugin) &&
                 inverse::register_lightstagetestsrc(plugin) &&
                 inverse::register_filter(plugin, inverse::kOlatRelight);
#if HAVE_ARAVIS
  all = all && inverse::register_lightstagearavissrc(plugin);
#endif
  return all;
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, inversestage,
                  "Light stages: lights in step with cameras, and relighting of captures",
                  plugin_init, VERSION, "LGPL", "gst-inverse", "Unknown package origin")
