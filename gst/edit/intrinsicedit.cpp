// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicedit: any effect of GStreamer on one layer of decomposed video, or of plain video.
#include <gst/gst.h>

#include "effects/effect_bin.hpp"
#include "gst/base/element_class.hpp"
#include "gst/base/pads/caps.hpp"

using inverse::EffectBin;
using inverse::Flow;

struct GstIntrinsicEdit {
  GstBin parent;
  EffectBin* body;
};

namespace {

using Class = inverse::ElementClass<GstIntrinsicEdit>;

GstStateChangeReturn change_state(GstElement* element, GstStateChange transition) {
  EffectBin& body = Class::body_of(element);
  if (transition == GST_STATE_CHANGE_READY_TO_PAUSED && !body.assemble()) {
    body.dismantle();
    return GST_STATE_CHANGE_FAILURE;
  }
  const GstStateChangeReturn result =
      GST_ELEMENT_CLASS(Class::parent_class)->change_state(element, transition);
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY) body.dismantle();
  return result;
}

void class_init(GstElementClass* element) {
  element->change_state = change_state;
  inverse::add_pad_template(element, "sink", GST_PAD_SINK, GST_PAD_ALWAYS,
                            inverse::template_caps(Flow::layers_or_pixels, inverse::kAnyLayers));
  inverse::add_pad_template(element, "src", GST_PAD_SRC, GST_PAD_ALWAYS,
                            inverse::template_caps(Flow::layers_or_pixels, inverse::kAnyLayers));
  Class::install_properties(
      element,
      "Times (ms) and memory (bytes) of the last completed frame, and pictures that did "
      "not come back",
      EffectBin::table());
}

constexpr Class kClass{"intrinsicedit",
                       "GstIntrinsicEdit",
                       "Intrinsic edit",
                       "Filter/Effect/Video",
                       "Changes one layer of video by any other effect",
                       gst_bin_get_type,
                       class_init,
                       [](GstIntrinsicEdit* self) { self->body = new EffectBin(GST_BIN(self)); }};

}  // namespace

namespace inverse {

gboolean register_intrinsicedit(GstPlugin* plugin);
gboolean register_intrinsicedit(GstPlugin* plugin) { return kClass.register_element(plugin); }

}  // namespace inverse
