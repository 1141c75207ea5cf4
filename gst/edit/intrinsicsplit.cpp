// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicsplit: outputs layers as ordinary video, one request pad each.
#include <gst/gst.h>

#include <cstring>
#include <string>

#include "gst/base/element_class.hpp"
#include "gst/base/pads/caps.hpp"
#include "gst/base/pads/pads.hpp"
#include "split_element.hpp"

using inverse::SplitBranch;
using inverse::SplitElement;
using inverse::SplitLayer;

struct GstIntrinsicSplit {
  GstElement parent;
  SplitElement* body;
};

namespace {

using Class = inverse::ElementClass<GstIntrinsicSplit>;

SplitElement& split_of(gpointer object) { return Class::body_of(object); }

gboolean src_event(GstPad* pad, GstObject* parent, GstEvent* event) {
  return split_of(parent).src_event(pad, event);
}

gboolean src_query(GstPad* pad, GstObject* parent, GstQuery* query) {
  return split_of(parent).src_query(pad, query);
}

std::string indirect_name(uint32_t base) { return "indirect_" + std::to_string(base); }

/// The base color of a pad "indirect_%u": what its name says, or the first that is free.
bool base_of(GstElement* element, const gchar* name, uint32_t* base) {
  if (name && g_str_has_prefix(name, "indirect_")) {
    guint64 number = 0;
    if (!g_ascii_string_to_unsigned(name + strlen("indirect_"), 10, 0, inverse::kMaxBases - 1,
                                    &number, nullptr))
      return false;
    *base = static_cast<uint32_t>(number);
    return true;
  }
  for (*base = 0; *base < inverse::kMaxBases; ++*base) {
    GstPad* pad = gst_element_get_static_pad(element, indirect_name(*base).c_str());
    if (!pad) return true;
    gst_object_unref(pad);
  }
  return false;
}

GstPad* request_new_pad(GstElement* element, GstPadTemplate* pad_template, const gchar* wanted,
                        const GstCaps*) {
  for (size_t i = 0; i < static_cast<size_t>(SplitLayer::count); ++i) {
    const auto layer = static_cast<SplitLayer>(i);
    const char* name = SplitBranch::template_of(layer);
    if (g_strcmp0(GST_PAD_TEMPLATE_NAME_TEMPLATE(pad_template), name) != 0) continue;
    uint32_t base = 0;
    const bool numbered = layer == SplitLayer::bounced;
    if (numbered && !base_of(element, wanted, &base)) return nullptr;
    GstPad* pad =
        gst_pad_new_from_template(pad_template, numbered ? indirect_name(base).c_str() : name);
    gst_pad_set_event_function(pad, src_event);
    gst_pad_set_query_function(pad, src_query);
    gst_pad_set_active(pad, TRUE);
    if (!split_of(element).add(pad, layer, base)) {
      gst_object_unref(pad);
      return nullptr;
    }
    gst_element_add_pad(element, pad);
    return pad;
  }
  return nullptr;
}

void release_pad(GstElement* element, GstPad* pad) { split_of(element).remove(pad); }

GstStateChangeReturn change_state(GstElement* element, GstStateChange transition) {
  const GstStateChangeReturn result =
      GST_ELEMENT_CLASS(Class::parent_class)->change_state(element, transition);
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY) split_of(element).stop();
  return result;
}

void class_init(GstElementClass* element) {
  element->request_new_pad = request_new_pad;
  element->release_pad = release_pad;
  element->change_state = change_state;
  inverse::add_pad_template(
      element, "sink", GST_PAD_SINK, GST_PAD_ALWAYS,
      inverse::template_caps(inverse::Flow::layers_or_pixels, inverse::kAllLayers));
  GstCaps* any = gst_caps_new_any();
  for (size_t i = 0; i < static_cast<size_t>(SplitLayer::count); ++i) {
    const auto layer = static_cast<SplitLayer>(i);
    inverse::add_pad_template(element, SplitBranch::template_of(layer), GST_PAD_SRC,
                              GST_PAD_REQUEST, SplitBranch::caps_for(layer, any));
  }
  gst_caps_unref(any);
  Class::install_properties(element, "Times (ms) and memory (bytes) of the last completed frame",
                            SplitElement::table());
}

GstFlowReturn chain(GstPad* sink, GstObject* parent, GstBuffer* buffer) {
  inverse::sync_controlled(GST_ELEMENT(parent), sink, buffer);
  return split_of(parent).chain(buffer);
}

gboolean sink_event(GstPad*, GstObject* parent, GstEvent* event) {
  return split_of(parent).sink_event(event);
}

gboolean sink_query(GstPad*, GstObject* parent, GstQuery* query) {
  return split_of(parent).sink_query(query);
}

void instance_init(GstIntrinsicSplit* self) {
  auto* element = GST_ELEMENT(self);
  GstPad* sink = gst_pad_new_from_template(
      gst_element_class_get_pad_template(GST_ELEMENT_GET_CLASS(element), "sink"), "sink");
  gst_pad_set_chain_function(sink, chain);
  gst_pad_set_event_function(sink, sink_event);
  gst_pad_set_query_function(sink, sink_query);
  GST_PAD_SET_ACCEPT_TEMPLATE(sink);  // negotiation names the source pad that refuses
  self->body = new SplitElement(element, sink);
  gst_element_add_pad(element, sink);
}

constexpr Class kClass{"intrinsicsplit",
                       "GstIntrinsicSplit",
                       "Intrinsic split",
                       "Filter/Video",
                       "Outputs layers as ordinary video; only requested pads are computed",
                       gst_element_get_type,
                       class_init,
                       instance_init};

}  // namespace

namespace inverse {

gboolean register_intrinsicsplit(GstPlugin* plugin);
gboolean register_intrinsicsplit(GstPlugin* plugin) { return kClass.register_element(plugin); }

}  // namespace inverse
