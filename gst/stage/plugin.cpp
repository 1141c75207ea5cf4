// The elements of light stages, nothing else.
#include <gst/gst.h>

#include "base/layers_meta.hpp"
#include "base/light_stage_meta.hpp"

static gboolean plugin_init(GstPlugin*) {
  inverse::register_layers_meta();
  inverse::register_light_stage_meta();
  return TRUE;
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, inversestage,
                  "Light stages: lights in step with cameras, and relighting what they saw",
                  plugin_init, VERSION, "LGPL", "gst-inverse", "Unknown package origin")
