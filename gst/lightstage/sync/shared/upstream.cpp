// SPDX-License-Identifier: LGPL-2.1-or-later
#include "upstream.hpp"

#include "gst/base/pads/pads.hpp"

namespace inverse {
namespace {

constexpr int kFarthest = 64;  // pads between
constexpr const char* kIdBits = "frame-id-bits";

ElementPtr found_upstream(GstPad* sink, bool (*wanted)(GstElement*), int distance) {
  const PadPtr peer(distance < kFarthest ? gst_pad_get_peer(sink) : nullptr);
  if (!peer) return nullptr;
  ElementPtr element = element_of_pad(peer.get());
  if (element && wanted(element.get())) return element;
  // Into an element that passes on, into a bin, or out of one.
  for (const PadPtr& inside : pads_behind(peer.get()))
    if (ElementPtr found = found_upstream(inside.get(), wanted, distance + 1)) return found;
  return nullptr;
}

/// Whether `frame-id-bits` is a number, or an enum whose values are these numbers.
bool has_id_bits(GstElement* element) {
  const GParamSpec* spec = g_object_class_find_property(G_OBJECT_GET_CLASS(element), kIdBits);
  return spec && (spec->flags & G_PARAM_READABLE) &&
         g_value_type_transformable(spec->value_type, G_TYPE_UINT);
}

}  // namespace

GstElement* upstream_element(GstPad* sink, bool (*wanted)(GstElement*)) {
  return found_upstream(sink, wanted, 0).release();
}

uint32_t upstream_id_bits(GstPad* sink) {
  GstElement* source = upstream_element(sink, has_id_bits);
  if (!source) return 0;
  GValue value = G_VALUE_INIT;
  g_value_init(&value, G_TYPE_UINT);
  g_object_get_property(G_OBJECT(source), kIdBits, &value);
  const guint bits = g_value_get_uint(&value);
  g_value_unset(&value);
  gst_object_unref(source);
  return bits == 16 || bits == 32 || bits == 64 ? bits : 0;
}

}  // namespace inverse
