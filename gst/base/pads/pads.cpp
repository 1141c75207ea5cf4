// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pads.hpp"

namespace inverse {
namespace {

std::string name_of(GstObject* object) {
  gchar* name = gst_object_get_name(object);
  std::string text = name ? name : "";
  g_free(name);
  return text;
}

}  // namespace

PadPtr linked_pad(GstPad* pad) {
  PadPtr peer(gst_pad_get_peer(pad));
  while (peer && GST_IS_PROXY_PAD(peer.get())) {
    if (GST_IS_GHOST_PAD(peer.get())) {  // into a bin
      peer.reset(gst_ghost_pad_get_target(GST_GHOST_PAD(peer.get())));
    } else {  // out of one
      const PadPtr outer(GST_PAD(gst_proxy_pad_get_internal(GST_PROXY_PAD(peer.get()))));
      peer.reset(outer ? gst_pad_get_peer(outer.get()) : nullptr);
    }
  }
  return peer;
}

std::vector<PadPtr> pads_behind(GstPad* pad) {
  std::vector<PadPtr> pads;
  GstIterator* links = gst_pad_iterate_internal_links(pad);
  if (!links) return pads;
  GValue item = G_VALUE_INIT;
  for (;;) {
    const GstIteratorResult result = gst_iterator_next(links, &item);
    if (result == GST_ITERATOR_OK) {
      pads.emplace_back(GST_PAD(g_value_dup_object(&item)));
      g_value_reset(&item);
    } else if (result == GST_ITERATOR_RESYNC) {
      gst_iterator_resync(links);
      pads.clear();
    } else {
      break;
    }
  }
  if (G_IS_VALUE(&item)) g_value_unset(&item);
  gst_iterator_free(links);
  return pads;
}

ElementPtr element_of_pad(GstPad* pad) { return ElementPtr(gst_pad_get_parent_element(pad)); }

void sync_controlled(GstElement* element, GstPad* sink, GstBuffer* buffer) {
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  if (GstEvent* event = gst_pad_get_sticky_event(sink, GST_EVENT_SEGMENT, 0)) {
    gst_event_copy_segment(event, &segment);
    gst_event_unref(event);
  }
  // Where upstream counts in bytes, there is no time to control by.
  const GstClockTime time =
      segment.format == GST_FORMAT_TIME
          ? gst_segment_to_stream_time(&segment, GST_FORMAT_TIME, GST_BUFFER_PTS(buffer))
          : GST_CLOCK_TIME_NONE;
  if (GST_CLOCK_TIME_IS_VALID(time)) gst_object_sync_values(GST_OBJECT(element), time);
}

std::string name_of(GstPad* pad) { return name_of(GST_OBJECT(pad)); }

std::string label_of(GstElement* element) {
  if (!element) return {};
  std::string name = name_of(GST_OBJECT(element));
  const GstElementFactory* factory = gst_element_get_factory(element);
  if (factory && !g_str_has_prefix(name.c_str(), GST_OBJECT_NAME(factory)))
    name += std::string(" (") + GST_OBJECT_NAME(factory) + ")";
  return name;
}

}  // namespace inverse
