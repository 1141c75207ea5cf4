// SPDX-License-Identifier: LGPL-2.1-or-later
// rgbdmerge: pictures with the depth images of their time.
#include "gst/base/element_class.hpp"
#include "gst/base/log/errors.hpp"
#include "rgbd_merge.hpp"

using inverse::RgbdMerge;

struct GstRgbdMerge {
  GstAggregator parent;
  RgbdMerge* body;
};

namespace {

using Class = inverse::ElementClass<GstRgbdMerge>;

RgbdMerge& merge_of(gpointer object) { return Class::body_of(object); }
GstAggregatorClass* parent_class() { return GST_AGGREGATOR_CLASS(Class::parent_class); }

gboolean start(GstAggregator* aggregator) {
  return inverse::check_parameters(inverse::log_of(GST_ELEMENT(aggregator)),
                                   merge_of(aggregator).parameters()) &&
         inverse::guarded(GST_ELEMENT(aggregator), [&] { merge_of(aggregator).start(); });
}

gboolean stop(GstAggregator* aggregator) {
  merge_of(aggregator).stop();
  return TRUE;
}

GstFlowReturn flush(GstAggregator* aggregator) {
  merge_of(aggregator).flush();
  return GST_FLOW_OK;
}

GstFlowReturn aggregate(GstAggregator* aggregator, gboolean timeout) {
  return merge_of(aggregator).aggregate(aggregator, timeout != FALSE);
}

/// Those of the pictures that come next: the pad's may be of later ones, which wait in it.
GstFlowReturn update_src_caps(GstAggregator* aggregator, GstCaps*, GstCaps** made) {
  *made = merge_of(aggregator).color_caps();
  return *made ? GST_FLOW_OK : GST_AGGREGATOR_FLOW_NEED_DATA;
}

gboolean sink_event(GstAggregator* aggregator, GstAggregatorPad* pad, GstEvent* event) {
  RgbdMerge& merge = merge_of(aggregator);
  const bool color = pad == merge.color();
  bool fine = true;
  if (GST_EVENT_TYPE(event) == GST_EVENT_CAPS) {
    GstCaps* caps = nullptr;
    gst_event_parse_caps(event, &caps);
    fine = inverse::guarded(GST_ELEMENT(aggregator), [&] {
      if (color)
        merge.set_color_caps(caps);
      else
        merge.set_depth_caps(caps);
    });
    if (color) gst_pad_mark_reconfigure(GST_AGGREGATOR_SRC_PAD(aggregator));
  } else if (GST_EVENT_TYPE(event) == GST_EVENT_SEGMENT && color) {
    // Pictures keep their time stamps.
    const GstSegment* segment = nullptr;
    gst_event_parse_segment(event, &segment);
    gst_aggregator_update_segment(aggregator, segment);
  } else if (GST_EVENT_TYPE(event) == GST_EVENT_TAG && !color) {
    gst_event_unref(event);
    return TRUE;
  }
  if (!fine) {
    gst_event_unref(event);
    return FALSE;
  }
  return parent_class()->sink_event(aggregator, pad, event);
}

gboolean sink_query(GstAggregator* aggregator, GstAggregatorPad* pad, GstQuery* query) {
  // What goes out has the pictures' format, so who takes it says which they may have.
  if (GST_QUERY_TYPE(query) == GST_QUERY_CAPS && pad == merge_of(aggregator).color()) {
    GstCaps* filter = nullptr;
    gst_query_parse_caps(query, &filter);
    GstCaps* taken = gst_pad_peer_query_caps(GST_AGGREGATOR_SRC_PAD(aggregator), filter);
    GstCaps* own = gst_pad_get_pad_template_caps(GST_PAD(pad));
    GstCaps* both = gst_caps_intersect_full(taken, own, GST_CAPS_INTERSECT_FIRST);
    gst_query_set_caps_result(query, both);
    for (GstCaps* caps : {taken, own, both}) gst_caps_unref(caps);
    return TRUE;
  }
  return parent_class()->sink_query(aggregator, pad, query);
}

void class_init(GstElementClass* element) {
  GstCaps* any = gst_caps_from_string("video/x-raw(ANY)");
  GstCaps* depth = gst_caps_from_string(
      "video/x-raw, format = (string) GRAY16_LE, width = (int) [ 1, 32767 ], height = (int) [ 1, "
      "32767 ], framerate = (fraction) [ 0, max ]");
  for (const auto& [name, direction, caps] :
       {std::tuple{"sink", GST_PAD_SINK, gst_caps_ref(any)}, {"depth", GST_PAD_SINK, depth}}) {
    gst_element_class_add_pad_template(
        element, gst_pad_template_new_with_gtype(name, direction, GST_PAD_ALWAYS, caps,
                                                 GST_TYPE_AGGREGATOR_PAD));
    gst_caps_unref(caps);
  }
  gst_element_class_add_pad_template(
      element, gst_pad_template_new_with_gtype("src", GST_PAD_SRC, GST_PAD_ALWAYS, any,
                                               GST_TYPE_AGGREGATOR_PAD));
  gst_caps_unref(any);
  auto* aggregator = GST_AGGREGATOR_CLASS(element);
  aggregator->start = start;
  aggregator->stop = stop;
  aggregator->flush = flush;
  aggregator->aggregate = aggregate;
  aggregator->update_src_caps = update_src_caps;
  aggregator->sink_event = sink_event;
  aggregator->sink_query = sink_query;
  aggregator->get_next_time = gst_aggregator_simple_get_next_time;
  Class::install_properties(element, "Pictures with depth, without, and depth images without one",
                            inverse::rgbd_merge_properties());
}

GstAggregatorPad* add_pad(GstElement* element, const char* name) {
  GstPadTemplate* made_of =
      gst_element_class_get_pad_template(GST_ELEMENT_GET_CLASS(element), name);
  auto* pad = GST_AGGREGATOR_PAD(g_object_new(GST_TYPE_AGGREGATOR_PAD, "name", name, "direction",
                                              GST_PAD_SINK, "template", made_of, nullptr));
  gst_element_add_pad(element, GST_PAD(pad));
  return pad;
}

void instance_init(GstRgbdMerge* self) {
  auto* element = GST_ELEMENT(self);
  GstAggregatorPad* color = add_pad(element, "sink");
  self->body = new RgbdMerge(element, color, add_pad(element, "depth"));
}

constexpr Class kClass{"rgbdmerge",
                       "GstRgbdMerge",
                       "RGB-D merger",
                       "Mixer/Video",
                       "Attaches the depth images of a second stream to the pictures of their time",
                       gst_aggregator_get_type,
                       class_init,
                       instance_init};

}  // namespace

namespace inverse {

gboolean register_rgbdmerge(GstPlugin* plugin);
gboolean register_rgbdmerge(GstPlugin* plugin) { return kClass.register_element(plugin); }

}  // namespace inverse
