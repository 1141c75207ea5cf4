// SPDX-License-Identifier: LGPL-2.1-or-later
// lightstagesync: labels each frame of the cameras of a light stage with the lights that lit it,
// synchronizes the cameras, and assembles frames.
#include <gst/gst.h>
#include <gst/video/video.h>

#include <cstring>
#include <string>

#include "gst/base/element_class.hpp"
#include "gst/base/pads/caps.hpp"
#include "sync_element.hpp"

using inverse::SyncElement;

struct GstLightStageSync {
  GstElement parent;
  SyncElement* body;
};

namespace {

using Class = inverse::ElementClass<GstLightStageSync>;

SyncElement& sync_of(gpointer object) { return Class::body_of(object); }

/// The camera of a pad, which may just be given back.
SyncElement::CameraPtr camera_of(GstPad* pad, GstObject* parent) {
  return sync_of(parent).find(pad);
}

/// Pads are made active before they have a parent.
SyncElement& sync_of_pad(GstPad* pad) {
  return *static_cast<SyncElement*>(gst_pad_get_element_private(pad));
}

GstFlowReturn chain(GstPad* pad, GstObject* parent, GstBuffer* buffer) {
  const auto camera = camera_of(pad, parent);
  GST_CAT_LOG_OBJECT(sync_of(parent).log().category, pad, "%" GST_PTR_FORMAT, buffer);
  if (camera) return sync_of(parent).chain(camera, buffer);
  gst_buffer_unref(buffer);
  return GST_FLOW_FLUSHING;
}

gboolean sink_event(GstPad* pad, GstObject* parent, GstEvent* event) {
  const inverse::Log& log = sync_of(parent).log();
  if (GST_EVENT_TYPE(event) == GST_EVENT_CAPS)
    GST_CAT_INFO_OBJECT(log.category, pad, "%" GST_PTR_FORMAT, event);
  else
    GST_CAT_DEBUG_OBJECT(log.category, pad, "%" GST_PTR_FORMAT, event);
  const auto camera = camera_of(pad, parent);
  if (camera) return sync_of(parent).sink_event(camera, event);
  gst_event_unref(event);
  return FALSE;
}

gboolean sink_query(GstPad* pad, GstObject* parent, GstQuery* query) {
  const auto camera = camera_of(pad, parent);
  return camera && sync_of(parent).sink_query(camera, query);
}

gboolean src_event(GstPad* pad, GstObject* parent, GstEvent* event) {
  if (const auto camera = camera_of(pad, parent)) return sync_of(parent).src_event(camera, event);
  gst_event_unref(event);
  return FALSE;
}

gboolean src_query(GstPad* pad, GstObject* parent, GstQuery* query) {
  const auto camera = camera_of(pad, parent);
  return camera && sync_of(parent).src_query(camera, query);
}

gboolean activate_sink(GstPad* pad, GstObject*, GstPadMode mode, gboolean active) {
  if (mode != GST_PAD_MODE_PUSH) return FALSE;
  const auto camera = sync_of_pad(pad).find(pad);
  return !camera || sync_of_pad(pad).activate_sink(camera, active);
}

gboolean activate_src(GstPad* pad, GstObject*, GstPadMode mode, gboolean active) {
  if (mode != GST_PAD_MODE_PUSH) return FALSE;
  const auto camera = sync_of_pad(pad).find(pad);
  if (camera) return sync_of_pad(pad).activate_src(camera, active);
  return active ? TRUE : gst_pad_stop_task(pad);
}

GstIterator* linked_inside(GstPad* pad, GstObject* parent) {
  const auto camera = camera_of(pad, parent);
  if (!camera) return nullptr;
  GValue other = G_VALUE_INIT;
  g_value_init(&other, GST_TYPE_PAD);
  g_value_set_object(&other, pad == camera->sink ? camera->src : camera->sink);
  GstIterator* iterator = gst_iterator_new_single(GST_TYPE_PAD, &other);
  g_value_unset(&other);
  return iterator;
}

bool is_running(GstElement* element) {
  GST_OBJECT_LOCK(element);
  const bool running = GST_STATE_TARGET(element) > GST_STATE_READY;
  GST_OBJECT_UNLOCK(element);
  return running;
}

/// A camera was added or removed: frames wait for those of other cameras.
void post_latency(GstElement* element) {
  if (is_running(element))
    gst_element_post_message(element, gst_message_new_latency(GST_OBJECT(element)));
}

GstPad* request_new_pad(GstElement* element, GstPadTemplate* sink_template, const gchar* wanted,
                        const GstCaps*) {
  SyncElement& sync = sync_of(element);
  guint64 number = 0;
  if (wanted && g_str_has_prefix(wanted, "sink_")) {
    if (!g_ascii_string_to_unsigned(wanted + strlen("sink_"), 10, 0, G_MAXUINT32 - 1, &number,
                                    nullptr))
      return nullptr;
    if (sync.has(static_cast<uint32_t>(number))) return nullptr;
  } else {
    while (sync.has(static_cast<uint32_t>(number))) ++number;
  }
  const std::string digits = std::to_string(number);
  GstPad* sink = gst_pad_new_from_template(sink_template, ("sink_" + digits).c_str());
  GstPad* src = gst_pad_new_from_template(
      gst_element_class_get_pad_template(GST_ELEMENT_GET_CLASS(element), "src_%u"),
      ("src_" + digits).c_str());
  gst_pad_set_chain_function(sink, chain);
  gst_pad_set_event_function(sink, sink_event);
  gst_pad_set_query_function(sink, sink_query);
  gst_pad_set_activatemode_function(sink, activate_sink);
  gst_pad_set_event_function(src, src_event);
  gst_pad_set_query_function(src, src_query);
  gst_pad_set_activatemode_function(src, activate_src);
  for (GstPad* pad : {sink, src}) {
    gst_pad_set_iterate_internal_links_function(pad, linked_inside);
    gst_pad_set_element_private(pad, &sync);
  }
  GST_PAD_SET_ACCEPT_TEMPLATE(sink);
  sync.add(static_cast<uint32_t>(number), sink, src);
  const bool running = is_running(element);
  for (GstPad* pad : {src, sink}) {
    if (running) gst_pad_set_active(pad, TRUE);
    gst_element_add_pad(element, pad);
  }
  post_latency(element);
  return sink;
}

void release_pad(GstElement* element, GstPad* pad) {
  const auto camera = sync_of(element).find(pad);
  if (!camera) return;
  sync_of(element).remove(camera);
  gst_element_remove_pad(element, camera->src);
  gst_element_remove_pad(element, camera->sink);
  post_latency(element);
}

GstStateChangeReturn change_state(GstElement* element, GstStateChange transition) {
  SyncElement& sync = sync_of(element);
  if (transition == GST_STATE_CHANGE_READY_TO_PAUSED && !sync.start())
    return GST_STATE_CHANGE_FAILURE;
  if (transition == GST_STATE_CHANGE_PAUSED_TO_PLAYING) sync.set_playing(true);
  if (transition == GST_STATE_CHANGE_PLAYING_TO_PAUSED) sync.set_playing(false);
  const GstStateChangeReturn result =
      GST_ELEMENT_CLASS(Class::parent_class)->change_state(element, transition);
  const bool not_started =
      transition == GST_STATE_CHANGE_READY_TO_PAUSED && result == GST_STATE_CHANGE_FAILURE;
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY || not_started) sync.stop();
  return result;
}

void set_context(GstElement* element, GstContext* context) {
  sync_of(element).context().set_context(context);
  GST_ELEMENT_CLASS(Class::parent_class)->set_context(element, context);
}

void class_init(GstElementClass* element) {
  element->request_new_pad = request_new_pad;
  element->release_pad = release_pad;
  element->change_state = change_state;
  element->set_context = set_context;
  GstCaps* raw = inverse::pixel_caps();
  GstCaps* out = inverse::assembled_caps(raw, inverse::SyncParams::Assemble::pairs);  // all of it
  inverse::add_pad_template(element, "sink_%u", GST_PAD_SINK, GST_PAD_REQUEST, raw);
  inverse::add_pad_template(element, "src_%u", GST_PAD_SRC, GST_PAD_SOMETIMES, out);
  Class::install_properties(
      element, "Counts of frames, labels and sets, of all cameras and of each (sink_0 …)",
      inverse::sync_properties());
}

constexpr Class kClass{
    "lightstagesync",
    "GstLightStageSync",
    "Light stage sync",
    "Filter/Video",
    "Labels each frame with the lights that lit it, joins cameras, and assembles pairs or captures",
    gst_element_get_type,
    class_init,
    [](GstLightStageSync* self) { self->body = new SyncElement(GST_ELEMENT(self)); }};

}  // namespace

namespace inverse {

gboolean register_lightstagesync(GstPlugin* plugin);
gboolean register_lightstagesync(GstPlugin* plugin) { return kClass.register_element(plugin); }

}  // namespace inverse
