// SPDX-License-Identifier: LGPL-2.1-or-later
#include "filter.hpp"

#include <gst/base/gstbasetransform.h>
#include <gst/video/navigation.h>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "child_settings.hpp"
#include "element_class.hpp"
#include "filter_element.hpp"
#include "gst/base/log/errors.hpp"
#include "gst/base/pads/missing_layers.hpp"
#include "report.hpp"

using inverse::ElementInfo;
using inverse::FilterElement;
using inverse::install_parameters;
using inverse::set_parameter;

struct GstInverseFilter {
  GstBaseTransform parent;
  FilterElement* element;
  inverse::ChildSettings* children;
};

struct GstInverseFilterClass {
  GstBaseTransformClass parent;
  const ElementInfo* info;
};

namespace {

enum : guint { PROP_DEVICE = 1, PROP_STATS, PROP_TABLE = 10 };

GstBaseTransformClass* parent_class = nullptr;

GstInverseFilter* self_of(gpointer object) { return static_cast<GstInverseFilter*>(object); }
FilterElement& element_of(gpointer object) { return *self_of(object)->element; }
inverse::ChildSettings& children_of(gpointer object) { return *self_of(object)->children; }
const ElementInfo& info_of(gpointer object) {
  return *reinterpret_cast<GstInverseFilterClass*>(G_OBJECT_GET_CLASS(object))->info;
}

void get_property(GObject* object, guint id, GValue* value, GParamSpec* spec) {
  FilterElement& element = element_of(object);
  if (id >= PROP_TABLE)
    element.filter().parameters().get(id - PROP_TABLE, value);
  else if (id == PROP_DEVICE)
    g_value_set_string(value, element.device_name().c_str());
  else if (id == PROP_STATS)
    g_value_take_boxed(value, element.stats());
  else
    G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
}

void set_property(GObject* object, guint id, const GValue* value, GParamSpec* spec) {
  FilterElement& element = element_of(object);
  if (id >= PROP_TABLE)
    set_parameter(element.log(), element.filter().parameters(), id - PROP_TABLE, value);
  else if (id == PROP_DEVICE)
    element.set_device_name(g_value_get_string(value));
  else
    G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
}

void finalize(GObject* object) {
  delete self_of(object)->children;
  delete self_of(object)->element;
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

GstStateChangeReturn change_state(GstElement* element, GstStateChange transition) {
  if (transition == GST_STATE_CHANGE_NULL_TO_READY && !element_of(element).open())
    return GST_STATE_CHANGE_FAILURE;
  // Before streaming starts again and frees what is left.
  if (transition == GST_STATE_CHANGE_READY_TO_PAUSED) {
    element_of(element).context().wait_for_neighbor();
    if (!element_of(element).restart()) return GST_STATE_CHANGE_FAILURE;
    element_of(element).set_flushing(false);
  }
  if (transition == GST_STATE_CHANGE_PAUSED_TO_READY) element_of(element).set_flushing(true);
  const GstStateChangeReturn result =
      GST_ELEMENT_CLASS(parent_class)->change_state(element, transition);
  if (transition == GST_STATE_CHANGE_READY_TO_NULL) element_of(element).close();
  return result;
}

GstPad* request_new_pad(GstElement* element, GstPadTemplate* pad_template, const gchar*,
                        const GstCaps*) {
  inverse::SidePads* pads = element_of(element).filter().side_pads();
  GstPad* pad = pads ? pads->request(element, pad_template) : nullptr;
  if (pad) gst_element_add_pad(element, pad);
  return pad;
}

void release_pad(GstElement* element, GstPad* pad) {
  gst_pad_set_active(pad, FALSE);
  element_of(element).filter().side_pads()->release(pad);
  gst_element_remove_pad(element, pad);
}

void set_context(GstElement* element, GstContext* context) {
  element_of(element).context().set_context(context);
  GST_ELEMENT_CLASS(parent_class)->set_context(element, context);
}

GstCaps* transform_caps(GstBaseTransform* transform, GstPadDirection direction, GstCaps* caps,
                        GstCaps* filter) {
  const ElementInfo& info = info_of(transform);
  GstCaps* templates = direction == GST_PAD_SINK ? info.src_caps() : info.sink_caps();
  return info.plain_caps ? info.plain_caps(direction, caps, templates, filter)
                         : inverse::transform_caps(caps, templates, filter);
}

GstCaps* fixate_caps(GstBaseTransform* base, GstPadDirection direction, GstCaps* caps,
                     GstCaps* other) {
  if (direction == GST_PAD_SINK && inverse::wants_layers(GST_BASE_TRANSFORM_SRC_PAD(base))) {
    GstCaps* ordered = inverse::prefer_layers(other);
    gst_caps_unref(other);
    other = ordered;
  }
  return inverse::fixate_caps(caps, other);
}

gboolean set_caps(GstBaseTransform* transform, GstCaps* in, GstCaps* out) {
  return element_of(transform).set_caps(in, out);
}

/// The pad refuses caps outside its template before any function of ours is called.
GstPadProbeReturn see_caps(GstPad*, GstPadProbeInfo* probe, gpointer transform) {
  GstEvent* event = GST_PAD_PROBE_INFO_EVENT(probe);
  if (GST_EVENT_TYPE(event) != GST_EVENT_CAPS) return GST_PAD_PROBE_OK;
  GstCaps* caps = nullptr;
  gst_event_parse_caps(event, &caps);
  element_of(transform).check_format(caps);
  return GST_PAD_PROBE_OK;
}

gboolean stop(GstBaseTransform* transform) {
  element_of(transform).ended();
  element_of(transform).stop();
  return TRUE;
}

gboolean transform_size(GstBaseTransform*, GstPadDirection direction, GstCaps*, gsize,
                        GstCaps* other, gsize* size) {
  if (direction != GST_PAD_SINK) return FALSE;
  GstVideoInfo info;
  if (inverse::carries_layers(other))
    *size = 0;
  else if (gst_video_info_from_caps(&info, other))
    *size = GST_VIDEO_INFO_SIZE(&info);
  else
    return FALSE;
  return TRUE;
}

gboolean propose_allocation(GstBaseTransform* transform, GstQuery*, GstQuery* query) {
  // Frames may come with any strides and offsets.
  gst_query_add_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr);
  element_of(transform).propose_memory(query);
  return TRUE;
}

gboolean decide_allocation(GstBaseTransform* transform, GstQuery* query) {
  GstCaps* caps = nullptr;
  gst_query_parse_allocation(query, &caps, nullptr);
  if (!caps || inverse::carries_layers(caps)) {
    // No memory goes out, so there is nothing to allocate.
    while (gst_query_get_n_allocation_pools(query) > 0)
      gst_query_remove_nth_allocation_pool(query, 0);
    return TRUE;
  }
  GstVideoInfo info;
  if (!gst_video_info_from_caps(&info, caps)) return FALSE;
  GstBufferPool* pool = nullptr;
  if (element_of(transform).sends_images()) {
    // Pools of other elements may make images that this one cannot write to.
    guint size = 0;
    if (!(pool = element_of(transform).image_pool(caps, &size))) return FALSE;
    while (gst_query_get_n_allocation_pools(query) > 0)
      gst_query_remove_nth_allocation_pool(query, 0);
    gst_query_add_allocation_pool(query, pool, size, 0, 0);
    gst_object_unref(pool);
    return TRUE;
  }
  element_of(transform).decide_memory(query);
  guint size = 0, min = 0, max = 0;
  const bool proposed = gst_query_get_n_allocation_pools(query) > 0;
  if (proposed) gst_query_parse_nth_allocation_pool(query, 0, &pool, &size, &min, &max);
  if (!pool) pool = gst_video_buffer_pool_new();
  size = MAX(size, static_cast<guint>(GST_VIDEO_INFO_SIZE(&info)));
  GstStructure* config = gst_buffer_pool_get_config(pool);
  gst_buffer_pool_config_set_params(config, caps, size, min, max);
  if (gst_query_find_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr))
    gst_buffer_pool_config_add_option(config, GST_BUFFER_POOL_OPTION_VIDEO_META);
  gst_buffer_pool_set_config(pool, config);
  if (proposed)
    gst_query_set_nth_allocation_pool(query, 0, pool, size, min, max);
  else
    gst_query_add_allocation_pool(query, pool, size, min, max);
  gst_object_unref(pool);
  return GST_BASE_TRANSFORM_CLASS(parent_class)->decide_allocation(transform, query);
}

GstFlowReturn prepare_output_buffer(GstBaseTransform* transform, GstBuffer* in, GstBuffer** out) {
  if (!element_of(transform).sends_layers() && !inverse::is_gap(in))
    return GST_BASE_TRANSFORM_CLASS(parent_class)->prepare_output_buffer(transform, in, out);
  *out = gst_buffer_new();
  return GST_BASE_TRANSFORM_GET_CLASS(transform)->copy_metadata(transform, in, *out)
             ? GST_FLOW_OK
             : GST_FLOW_ERROR;
}

gboolean transform_meta(GstBaseTransform* transform, GstBuffer*, GstMeta* meta, GstBuffer*) {
  // Metas about the picture stay true if it keeps its size; metas about its memory do not.
  if (element_of(transform).resizes() &&
      gst_meta_api_type_has_tag(meta->info->api,
                                g_quark_from_static_string(GST_META_TAG_VIDEO_SIZE_STR)))
    return FALSE;
  return !gst_meta_api_type_has_tag(meta->info->api,
                                    g_quark_from_static_string(GST_META_TAG_MEMORY_STR));
}

void before_transform(GstBaseTransform* transform, GstBuffer* buffer) {
  // An appsrc or filesrc has segments in bytes by default.
  if (transform->segment.format != GST_FORMAT_TIME) return;
  const GstClockTime time = gst_segment_to_stream_time(&transform->segment, GST_FORMAT_TIME,
                                                       GST_BUFFER_TIMESTAMP(buffer));
  if (!GST_CLOCK_TIME_IS_VALID(time)) return;
  gst_object_sync_values(GST_OBJECT(transform), time);
  children_of(transform).sync(time);
}

GstFlowReturn transform(GstBaseTransform* transform, GstBuffer* in, GstBuffer* out) {
  // A gap stays one. A frame that is flagged so is still a frame, and its result is no gap.
  if (inverse::is_gap(in)) return GST_FLOW_OK;
  GST_BUFFER_FLAG_UNSET(out, GST_BUFFER_FLAG_GAP);
  return element_of(transform).transform(in, out);
}

gboolean sink_event(GstBaseTransform* transform, GstEvent* event) {
  const inverse::Log& log = element_of(transform).log();
  GST_CAT_DEBUG_OBJECT(log.category, log.object, "event: %" GST_PTR_FORMAT, event);
  if (GST_EVENT_TYPE(event) == GST_EVENT_FLUSH_START) element_of(transform).set_flushing(true);
  if (GST_EVENT_TYPE(event) == GST_EVENT_FLUSH_STOP) {
    element_of(transform).set_flushing(false);
    element_of(transform).flush("flush");
  }
  if (GST_EVENT_TYPE(event) == GST_EVENT_STREAM_START) {
    const gchar* id = nullptr;
    gst_event_parse_stream_start(event, &id);
    element_of(transform).start_stream(id);
  }
  if (GST_EVENT_TYPE(event) == GST_EVENT_EOS) element_of(transform).ended();
  const bool caps = GST_EVENT_TYPE(event) == GST_EVENT_CAPS;
  const gboolean good = GST_BASE_TRANSFORM_CLASS(parent_class)->sink_event(transform, event);
  if (caps && !good) element_of(transform).explain_refusal();
  return good;
}

/// The mouse event in a navigation event of the first button or a move; empty for others.
std::optional<inverse::MouseEvent> mouse_event(GstEvent* event) {
  using Kind = inverse::MouseEvent::Kind;
  gint button = 0;
  gdouble x = 0, y = 0;
  switch (gst_navigation_event_get_type(event)) {
    case GST_NAVIGATION_EVENT_MOUSE_MOVE:
      if (!gst_navigation_event_parse_mouse_move_event(event, &x, &y)) return {};
      return {{Kind::move, x, y}};
    case GST_NAVIGATION_EVENT_MOUSE_BUTTON_PRESS:
    case GST_NAVIGATION_EVENT_MOUSE_BUTTON_RELEASE:
      if (!gst_navigation_event_parse_mouse_button_event(event, &button, &x, &y) || button != 1)
        return {};
      return {{gst_navigation_event_get_type(event) == GST_NAVIGATION_EVENT_MOUSE_BUTTON_PRESS
                   ? Kind::press
                   : Kind::release,
               x, y}};
    default:
      return {};
  }
}

/// Hands a navigation event to the filter, and sets the properties that follow it.
void navigate(GstBaseTransform* transform, GstEvent* event) {
  const auto mouse = mouse_event(event);
  if (!mouse) return;
  const auto settings = element_of(transform).filter().navigate(*mouse);
  if (settings.empty()) return;
  // All are set before any is notified.
  g_object_freeze_notify(G_OBJECT(transform));
  for (const auto& [property, value] : settings) g_object_set(transform, property, value, nullptr);
  g_object_thaw_notify(G_OBJECT(transform));
}

gboolean src_event(GstBaseTransform* transform, GstEvent* event) {
  const inverse::Log& log = element_of(transform).log();
  if (GST_EVENT_TYPE(event) != GST_EVENT_QOS && GST_EVENT_TYPE(event) != GST_EVENT_NAVIGATION)
    GST_CAT_DEBUG_OBJECT(log.category, log.object, "event from downstream: %" GST_PTR_FORMAT,
                         event);
  if (GST_EVENT_TYPE(event) == GST_EVENT_QOS) {
    GstQOSType type{};
    GstClockTimeDiff late = 0;
    gst_event_parse_qos(event, &type, nullptr, &late, nullptr);
    // Throttling asks for fewer frames, not for cheaper ones.
    if (type != GST_QOS_TYPE_THROTTLE)
      element_of(transform).late(static_cast<double>(late) / GST_MSECOND);
  }
  if (GST_EVENT_TYPE(event) == GST_EVENT_NAVIGATION && info_of(transform).navigation)
    navigate(transform, event);
  return GST_BASE_TRANSFORM_CLASS(parent_class)->src_event(transform, event);
}

/// The class closure of an action signal; its data is the Action.
void run_action(GClosure* closure, GValue* result, guint, const GValue* values, gpointer,
                gpointer) {
  const bool done = element_of(g_value_get_object(values))
                        .run(*static_cast<const inverse::Action*>(closure->data), values + 1);
  if (result) g_value_set_boolean(result, done);
}

void add_action(GType type, const inverse::Action& action) {
  GClosure* closure = g_closure_new_simple(sizeof(GClosure), const_cast<inverse::Action*>(&action));
  g_closure_set_marshal(closure, run_action);
  std::vector<GType> arguments = action.arguments;
  g_signal_newv(action.name, type, static_cast<GSignalFlags>(G_SIGNAL_RUN_LAST | G_SIGNAL_ACTION),
                closure, nullptr, nullptr, nullptr,
                action.returns_success ? G_TYPE_BOOLEAN : G_TYPE_NONE,
                static_cast<guint>(arguments.size()), arguments.data());
}

gboolean query(GstBaseTransform* transform, GstPadDirection direction, GstQuery* query) {
  const bool asks_context = GST_QUERY_TYPE(query) == GST_QUERY_CONTEXT;
  if (asks_context && element_of(transform).context().answer(query)) return TRUE;
  if (!GST_BASE_TRANSFORM_CLASS(parent_class)->query(transform, direction, query))
    return asks_context && element_of(transform).context().provide(query);
  if (GST_QUERY_TYPE(query) == GST_QUERY_CAPS && direction == GST_PAD_SINK &&
      info_of(transform).sink == inverse::Flow::layers_or_pixels) {
    GstCaps* caps = nullptr;
    gst_query_parse_caps_result(query, &caps);
    caps = inverse::prefer_layers(caps);
    gst_query_set_caps_result(query, caps);
    gst_caps_unref(caps);
  }
  if (GST_QUERY_TYPE(query) == GST_QUERY_LATENCY && direction == GST_PAD_SRC) {
    if (inverse::SidePads* pads = element_of(transform).filter().side_pads())
      pads->add_latency(query);
    inverse::add_latency(query, element_of(transform).latency());
    const inverse::Log& log = element_of(transform).log();
    GST_CAT_DEBUG_OBJECT(log.category, log.object, "answer: %" GST_PTR_FORMAT, query);
  }
  return TRUE;
}

void base_class_init(gpointer klass, gpointer) {
  parent_class = static_cast<GstBaseTransformClass*>(g_type_class_peek_parent(klass));
  auto* object = G_OBJECT_CLASS(klass);
  object->finalize = finalize;
  auto* element = GST_ELEMENT_CLASS(klass);
  element->change_state = change_state;
  element->request_new_pad = request_new_pad;
  element->release_pad = release_pad;
  element->set_context = set_context;
  auto* base = GST_BASE_TRANSFORM_CLASS(klass);
  base->transform_caps = transform_caps;
  base->fixate_caps = fixate_caps;
  base->set_caps = set_caps;
  base->stop = stop;
  base->transform_size = transform_size;
  base->propose_allocation = propose_allocation;
  base->decide_allocation = decide_allocation;
  base->prepare_output_buffer = prepare_output_buffer;
  base->transform_meta = transform_meta;
  base->before_transform = before_transform;
  base->transform = transform;
  base->sink_event = sink_event;
  base->src_event = src_event;
  base->query = query;
  base->passthrough_on_same_caps = FALSE;
}

void element_class_init(gpointer klass, gpointer data) {
  const auto& info = *static_cast<const ElementInfo*>(data);
  static_cast<GstInverseFilterClass*>(klass)->info = &info;
  auto* element = GST_ELEMENT_CLASS(klass);
  gst_element_class_set_static_metadata(element, info.long_name, info.klass, info.description,
                                        "the gst-inverse authors");
  inverse::add_pad_template(element, "sink", GST_PAD_SINK, GST_PAD_ALWAYS, info.sink_caps());
  inverse::add_pad_template(element, "src", GST_PAD_SRC, GST_PAD_ALWAYS, info.src_caps());
  for (const char* name : info.side_sinks)
    inverse::add_pad_template(element, name, GST_PAD_SINK, GST_PAD_REQUEST, inverse::pixel_caps());
  auto* object = G_OBJECT_CLASS(klass);
  object->get_property = get_property;  // GObject does not inherit these two
  object->set_property = set_property;
  if (info.takes_pixels())
    g_object_class_install_property(
        object, PROP_DEVICE,
        g_param_spec_string("device", "device",
                            "Vulkan device: an index or a part of its name; empty = shared with "
                            "neighbors, else INVERSE_DEVICE, else the fastest",
                            "",
                            static_cast<GParamFlags>(G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
                                                     GST_PARAM_MUTABLE_READY)));
  g_object_class_install_property(
      object, PROP_STATS,
      g_param_spec_boxed(
          "stats", "stats", "Times (ms), memory (bytes) and results of the last completed frame",
          GST_TYPE_STRUCTURE, static_cast<GParamFlags>(G_PARAM_READABLE | G_PARAM_STATIC_STRINGS)));
  install_parameters(klass, info.create()->parameters(), PROP_TABLE);
  for (const auto& action : info.actions) add_action(G_TYPE_FROM_CLASS(klass), action);
}

/// What a preset saves: the parameters; neither the device nor properties of GStreamer's classes.
gchar** preset_properties(GstPreset* preset) {
  GPtrArray* names = g_ptr_array_new();
  const auto add = [names](gpointer object, guint first_id, const std::string& child) {
    guint count = 0;
    const std::unique_ptr<GParamSpec*, decltype(&g_free)> specs(
        g_object_class_list_properties(G_OBJECT_GET_CLASS(object), &count), g_free);
    for (GParamSpec* spec : std::span(specs.get(), count))
      if (spec->owner_type == G_OBJECT_TYPE(object) && (spec->flags & G_PARAM_WRITABLE) &&
          spec->param_id >= first_id)
        g_ptr_array_add(names, g_strdup((child + spec->name).c_str()));
  };
  add(preset, PROP_TABLE, "");
  for (GstObject* child : children_of(preset).all())
    add(child, 1, std::string(GST_OBJECT_NAME(child)) + "::");
  g_ptr_array_add(names, nullptr);
  return reinterpret_cast<gchar**>(g_ptr_array_free(names, FALSE));
}

void preset_init(gpointer interface, gpointer) {
  static_cast<GstPresetInterface*>(interface)->get_property_names = preset_properties;
}

void instance_init(GTypeInstance* instance, gpointer klass) {
  auto* self = self_of(instance);
  self->element =
      new FilterElement(GST_ELEMENT(instance), *static_cast<GstInverseFilterClass*>(klass)->info);
  self->children =
      new inverse::ChildSettings(GST_ELEMENT(instance), self->element->filter().parameters());
  gst_base_transform_set_qos_enabled(GST_BASE_TRANSFORM(instance), TRUE);
  gst_base_transform_set_gap_aware(GST_BASE_TRANSFORM(instance), TRUE);
  if (static_cast<GstInverseFilterClass*>(klass)->info->takes_pixels())
    gst_pad_add_probe(GST_BASE_TRANSFORM_SINK_PAD(instance), GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM,
                      see_caps, instance, nullptr);
}

/// The base type of all elements of a plugin: one for each plugin, as each has its own code.
GType filter_type(GstPlugin* plugin) {
  static const GType type = [plugin] {
    const std::string name = std::string("GstInverseFilter-") + gst_plugin_get_name(plugin);
    GTypeInfo info{};
    info.class_size = sizeof(GstInverseFilterClass);
    info.class_init = base_class_init;
    info.instance_size = sizeof(GstInverseFilter);
    return g_type_register_static(GST_TYPE_BASE_TRANSFORM, name.c_str(), &info,
                                  G_TYPE_FLAG_ABSTRACT);
  }();
  return type;
}

}  // namespace

namespace inverse {

Filter& filter_of(GstElement* element) { return element_of(element).filter(); }

gboolean register_filter(GstPlugin* plugin, const ElementInfo& element) {
  debug_category(element.factory, element.description);
  GTypeInfo info{};
  info.class_size = sizeof(GstInverseFilterClass);
  info.class_init = element_class_init;
  info.class_data = &element;
  info.instance_size = sizeof(GstInverseFilter);
  info.instance_init = instance_init;
  const GType type = g_type_register_static(filter_type(plugin), element.type_name, &info,
                                            static_cast<GTypeFlags>(0));
  const GInterfaceInfo presets{preset_init, nullptr, nullptr},
      children{ChildSettings::init_interface<children_of>, nullptr, nullptr};
  g_type_add_interface_static(type, GST_TYPE_PRESET, &presets);
  g_type_add_interface_static(type, GST_TYPE_CHILD_PROXY, &children);
  return gst_element_register(plugin, element.factory, GST_RANK_NONE, type);
}

}  // namespace inverse
