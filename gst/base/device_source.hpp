// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/base/gstbasesrc.h>

#include "gst/base/element_class.hpp"
#include "gst/base/log/errors.hpp"
#include "gst/base/pads/caps.hpp"

namespace inverse {

/// What sources share that draw pictures on a Vulkan device. `Class` is an ElementClass whose body
/// has `context()`, a DeviceContext, and `params()` with `device` and `live`.
template <typename Class>
struct DeviceSource {
  /// Sets what the functions below do, and the pad's template.
  static void class_init(GstElementClass* element) {
    element->change_state = change_state;
    element->set_context = set_context;
    add_pad_template(element, "src", GST_PAD_SRC, GST_PAD_ALWAYS, pixel_caps());
  }
  /// GstBaseSrc::fixate to this size, or that nearest to it, and to square pixels.
  static GstCaps* fixate(GstBaseSrc* base, GstCaps* caps, gint width, gint height) {
    caps = gst_caps_make_writable(gst_caps_truncate(caps));
    GstStructure* structure = gst_caps_get_structure(caps, 0);
    gst_structure_fixate_field_nearest_int(structure, "width", width);
    gst_structure_fixate_field_nearest_int(structure, "height", height);
    if (gst_structure_has_field(structure, "pixel-aspect-ratio"))
      gst_structure_fixate_field_nearest_fraction(structure, "pixel-aspect-ratio", 1, 1);
    return GST_BASE_SRC_CLASS(Class::parent_class)->fixate(base, caps);
  }
  /// GstBaseSrc::query: answers about the device, and with a latency of one `period` if live.
  template <typename Period>
  static gboolean query(GstBaseSrc* base, GstQuery* query, Period period) {
    if (GST_QUERY_TYPE(query) == GST_QUERY_CONTEXT && Class::body_of(base).context().answer(query))
      return TRUE;
    if (GST_QUERY_TYPE(query) == GST_QUERY_LATENCY && gst_pad_has_current_caps(base->srcpad)) {
      const bool live = gst_base_src_is_live(base);
      gst_query_set_latency(query, live, live ? period() : 0, GST_CLOCK_TIME_NONE);
      return TRUE;
    }
    return GST_BASE_SRC_CLASS(Class::parent_class)->query(base, query);
  }

 private:
  static void set_context(GstElement* element, GstContext* context) {
    Class::body_of(element).context().set_context(context);
    GST_ELEMENT_CLASS(Class::parent_class)->set_context(element, context);
  }
  static GstStateChangeReturn change_state(GstElement* element, GstStateChange transition) {
    auto& source = Class::body_of(element);
    if (transition == GST_STATE_CHANGE_NULL_TO_READY &&
        !guarded(element, [&] { source.context().acquire(source.params().device); }))
      return GST_STATE_CHANGE_FAILURE;
    if (transition == GST_STATE_CHANGE_READY_TO_PAUSED)
      gst_base_src_set_live(GST_BASE_SRC(element), source.params().live);
    const GstStateChangeReturn result =
        GST_ELEMENT_CLASS(Class::parent_class)->change_state(element, transition);
    if (transition == GST_STATE_CHANGE_READY_TO_NULL) source.context().release();
    return result;
  }
};

}  // namespace inverse
