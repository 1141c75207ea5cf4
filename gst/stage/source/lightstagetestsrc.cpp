// SPDX-License-Identifier: LGPL-2.1-or-later
// lightstagetestsrc: a camera with a view of a head on a virtual light stage.
#include <gst/base/gstpushsrc.h>

#include <algorithm>

#include "gst/base/caps.hpp"
#include "gst/base/log/errors.hpp"
#include "gst/base/log/log.hpp"
#include "test_source.hpp"

using inverse::TestSource;

struct GstLightStageTestSrc {
  GstPushSrc parent;
  TestSource* source;
  // Of the streaming thread.
  bool running;            // the camera has begun
  uint64_t first, frame;   // its first and its next frame, periods from running time 0
  uint64_t start;          // of the program, the same
  GstClockTime last_time;  // time stamps do not go back
  GstBuffer* again;        // a frame that is to be sent a second time
  // Under the object's lock.
  GstClockID wait;
  gboolean flushing;
};

struct GstLightStageTestSrcClass {
  GstPushSrcClass parent;
};

namespace {

enum : guint { PROP_DEVICE = 1, PROP_STATS, PROP_LIVE, PROP_TABLE = 10 };
constexpr gint kWidth = 320, kHeight = 240;

gpointer parent_class = nullptr;

GstLightStageTestSrc& self_of(gpointer object) {
  return *static_cast<GstLightStageTestSrc*>(object);
}
TestSource& source_of(gpointer object) { return *self_of(object).source; }

void get_property(GObject* object, guint id, GValue* value, GParamSpec* spec) {
  TestSource& source = source_of(object);
  if (id >= PROP_TABLE)
    source.parameters().get(id - PROP_TABLE, value);
  else if (id == PROP_DEVICE)
    g_value_set_string(value, source.device_name().c_str());
  else if (id == PROP_STATS)
    g_value_take_boxed(value, source.stats());
  else if (id == PROP_LIVE)
    g_value_set_boolean(value, gst_base_src_is_live(GST_BASE_SRC(object)));
  else
    G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
}

void set_property(GObject* object, guint id, const GValue* value, GParamSpec* spec) {
  TestSource& source = source_of(object);
  if (id >= PROP_TABLE)
    inverse::set_parameter(inverse::log_of(GST_ELEMENT(object)), source.parameters(),
                           id - PROP_TABLE, value, spec);
  else if (id == PROP_DEVICE)
    source.set_device_name(g_value_get_string(value));
  else if (id == PROP_LIVE)
    gst_base_src_set_live(GST_BASE_SRC(object), g_value_get_boolean(value));
  else
    G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
}

void finalize(GObject* object) {
  delete self_of(object).source;
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

void set_context(GstElement* element, GstContext* context) {
  source_of(element).context().set_context(context);
  GST_ELEMENT_CLASS(parent_class)->set_context(element, context);
}

GstStateChangeReturn change_state(GstElement* element, GstStateChange transition) {
  TestSource& source = source_of(element);
  if (transition == GST_STATE_CHANGE_NULL_TO_READY &&
      !inverse::guarded(element, [&] { source.context().acquire(source.device_name()); }))
    return GST_STATE_CHANGE_FAILURE;
  const GstStateChangeReturn result =
      GST_ELEMENT_CLASS(parent_class)->change_state(element, transition);
  if (transition == GST_STATE_CHANGE_READY_TO_NULL) source.context().release();
  return result;
}

gboolean start(GstBaseSrc* base) {
  auto& self = self_of(base);
  std::string trouble;
  if (!inverse::check_parameters(inverse::log_of(GST_ELEMENT(base)), self.source->parameters()))
    return FALSE;
  if (!inverse::guarded(GST_ELEMENT(base), [&] { trouble = self.source->start(); })) return FALSE;
  if (!trouble.empty())
    inverse::post_warning(inverse::log_of(GST_ELEMENT(base)), GST_RESOURCE_ERROR,
                          GST_RESOURCE_ERROR_NOT_FOUND, "%s", trouble.c_str());
  self.running = false;
  self.last_time = 0;
  return TRUE;
}

gboolean stop(GstBaseSrc* base) {
  auto& self = self_of(base);
  gst_clear_buffer(&self.again);
  self.source->stop();
  return TRUE;
}

GstCaps* get_caps(GstBaseSrc* base, GstCaps* filter) {
  // Before the start any caps do; afterwards the program's.
  return inverse::filter_caps(source_of(base).caps(), filter);
}

GstCaps* fixate(GstBaseSrc* base, GstCaps* caps) {
  caps = gst_caps_make_writable(gst_caps_truncate(caps));
  GstStructure* structure = gst_caps_get_structure(caps, 0);
  gst_structure_fixate_field_nearest_int(structure, "width", kWidth);
  gst_structure_fixate_field_nearest_int(structure, "height", kHeight);
  if (gst_structure_has_field(structure, "pixel-aspect-ratio"))
    gst_structure_fixate_field_nearest_fraction(structure, "pixel-aspect-ratio", 1, 1);
  return GST_BASE_SRC_CLASS(parent_class)->fixate(base, caps);
}

bool flushing(GstLightStageTestSrc& self) {
  GST_OBJECT_LOCK(&self);
  const bool result = self.flushing;
  GST_OBJECT_UNLOCK(&self);
  return result;
}

gboolean set_caps(GstBaseSrc* base, GstCaps* caps) {
  const inverse::Log log = inverse::log_of(GST_ELEMENT(base));
  GST_CAT_INFO_OBJECT(log.category, base, "caps: %" GST_PTR_FORMAT, caps);
  bool done = false;
  const bool good = inverse::guarded(GST_ELEMENT(base), [&] {
    GstVideoInfo info;
    if (!gst_video_info_from_caps(&info, caps))
      throw inverse::Error(inverse::ErrorKind::unsupported,
                           "lightstagetestsrc was asked for an impossible video format");
    gst_base_src_set_blocksize(base, static_cast<guint>(GST_VIDEO_INFO_SIZE(&info)));
    done = source_of(base).set_caps(info, [base] { return !flushing(self_of(base)); });
  });
  return good && done;
}

gboolean decide_allocation(GstBaseSrc* base, GstQuery* query) {
  GstCaps* caps = nullptr;
  gst_query_parse_allocation(query, &caps, nullptr);
  GstVideoInfo info;
  if (!caps || !gst_video_info_from_caps(&info, caps)) return FALSE;
  GstBufferPool* pool = nullptr;
  guint size = 0, min_buffers = 0, max_buffers = 0;
  const bool offered = gst_query_get_n_allocation_pools(query) > 0;
  if (offered)
    gst_query_parse_nth_allocation_pool(query, 0, &pool, &size, &min_buffers, &max_buffers);
  size = std::max(size, static_cast<guint>(GST_VIDEO_INFO_SIZE(&info)));
  if (!pool) pool = gst_video_buffer_pool_new();
  GstStructure* config = gst_buffer_pool_get_config(pool);
  gst_buffer_pool_config_set_params(config, caps, size, min_buffers, max_buffers);
  if (gst_query_find_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr))
    gst_buffer_pool_config_add_option(config, GST_BUFFER_POOL_OPTION_VIDEO_META);
  gst_buffer_pool_set_config(pool, config);
  if (offered)
    gst_query_set_nth_allocation_pool(query, 0, pool, size, min_buffers, max_buffers);
  else
    gst_query_add_allocation_pool(query, pool, size, min_buffers, max_buffers);
  gst_object_unref(pool);
  return GST_BASE_SRC_CLASS(parent_class)->decide_allocation(base, query);
}

/// Sleeps until the pipeline's running time; says whether it was not interrupted.
bool wait_until(GstLightStageTestSrc& self, GstClockTime running) {
  auto* element = GST_ELEMENT(&self);
  GST_OBJECT_LOCK(element);
  GstClock* clock = GST_ELEMENT_CLOCK(element);
  if (self.flushing || !clock) {
    const bool free = !self.flushing;  // without a clock time does not pass
    GST_OBJECT_UNLOCK(element);
    return free;
  }
  const GstClockID id = gst_clock_new_single_shot_id(clock, element->base_time + running);
  self.wait = id;
  GST_OBJECT_UNLOCK(element);
  const GstClockReturn result = gst_clock_id_wait(id, nullptr);
  GST_OBJECT_LOCK(element);
  self.wait = nullptr;
  GST_OBJECT_UNLOCK(element);
  gst_clock_id_unref(id);
  return result != GST_CLOCK_UNSCHEDULED;
}

/// Starts the camera at the next period: rendering its view may have taken a while.
void begin(GstLightStageTestSrc& self, bool live) {
  self.frame = 0;
  if (live) {
    const GstClockTime now = gst_element_get_current_running_time(GST_ELEMENT(&self));
    if (GST_CLOCK_TIME_IS_VALID(now))
      self.frame = gst_util_uint64_scale_ceil(now, 1, self.source->period());
  }
  self.first = self.frame;
  self.start = self.source->said_start().value_or(self.first);
  self.running = true;
}

inverse::Exposure exposure_of(const GstLightStageTestSrc& self) {
  inverse::Exposure exposure{self.frame - self.first, std::nullopt};
  if (self.frame >= self.start) exposure.trigger = self.frame - self.start;
  return exposure;
}

/// Skips frames that a live camera would have lost while this machine was busy.
void catch_up(GstLightStageTestSrc& self) {
  constexpr uint64_t kBuffers = 4;  // as many may wait in a camera
  const GstClockTime now = gst_element_get_current_running_time(GST_ELEMENT(&self));
  if (!GST_CLOCK_TIME_IS_VALID(now)) return;
  uint64_t lost = 0;
  while (self.source->time_of(self.frame + lost + kBuffers) < now) ++lost;
  if (lost) self.source->overran(lost);
  self.frame += lost;
}

gboolean unlock(GstBaseSrc* base) {
  auto& self = self_of(base);
  GST_OBJECT_LOCK(base);
  self.flushing = TRUE;
  if (self.wait) gst_clock_id_unschedule(self.wait);
  GST_OBJECT_UNLOCK(base);
  return TRUE;
}

gboolean unlock_stop(GstBaseSrc* base) {
  GST_OBJECT_LOCK(base);
  self_of(base).flushing = FALSE;
  GST_OBJECT_UNLOCK(base);
  return TRUE;
}

GstFlowReturn create(GstPushSrc* push, GstBuffer** buffer) {
  auto& self = self_of(push);
  auto* base = GST_BASE_SRC(push);
  TestSource& source = *self.source;
  if (self.again) {
    *buffer = self.again;
    self.again = nullptr;
    return GST_FLOW_OK;
  }
  const bool live = gst_base_src_is_live(base);
  if (!self.running)
    begin(self, live);
  else if (live)
    catch_up(self);
  inverse::FrameFate fate;
  while (true) {
    if (flushing(self)) return GST_FLOW_FLUSHING;
    if (source.ended(exposure_of(self))) return GST_FLOW_EOS;
    gst_object_sync_values(GST_OBJECT(push), source.time_of(self.frame));
    fate = source.fate(exposure_of(self));
    if (!fate.dropped) break;
    source.count(true, false);
    ++self.frame;
    // If all frames are dropped, time still passes.
    if (live && !wait_until(self, source.time_of(self.frame))) return GST_FLOW_FLUSHING;
  }
  const GstClockTime time = source.time_of(self.frame);
  if (live && !wait_until(self, time + source.until_exposure(exposure_of(self))))
    return GST_FLOW_FLUSHING;
  GstBuffer* made = nullptr;
  const GstFlowReturn allocated =
      GST_BASE_SRC_CLASS(parent_class)->alloc(base, 0, gst_base_src_get_blocksize(base), &made);
  if (allocated != GST_FLOW_OK) return allocated;
  if (!inverse::guarded(GST_ELEMENT(push), [&] { source.draw(exposure_of(self), made); })) {
    gst_buffer_unref(made);
    return GST_FLOW_ERROR;
  }
  const auto shift =
      static_cast<GstClockTimeDiff>(fate.shift * static_cast<double>(source.period()));
  const GstClockTimeDiff stamped = static_cast<GstClockTimeDiff>(time) + shift;
  self.last_time =
      std::max(self.last_time, static_cast<GstClockTime>(std::max<GstClockTimeDiff>(stamped, 0)));
  GST_BUFFER_PTS(made) = self.last_time;
  GST_BUFFER_DTS(made) = GST_CLOCK_TIME_NONE;
  GST_BUFFER_DURATION(made) = source.time_of(self.frame + 1) - time;
  if (fate.duplicated) {
    source.count(false, true);
    self.again = gst_buffer_copy(made);
  }
  GST_CAT_LOG_OBJECT(inverse::log_of(GST_ELEMENT(push)).category, push,
                     "frame %" G_GUINT64_FORMAT ": %" GST_PTR_FORMAT, self.frame, made);
  ++self.frame;
  *buffer = made;
  return GST_FLOW_OK;
}

/// The frames of programs are in time, and lights do not go back.
gboolean is_seekable(GstBaseSrc*) { return FALSE; }

gboolean query(GstBaseSrc* base, GstQuery* query) {
  if (GST_QUERY_TYPE(query) == GST_QUERY_CONTEXT && source_of(base).context().answer(query))
    return TRUE;
  if (GST_QUERY_TYPE(query) == GST_QUERY_LATENCY && gst_pad_has_current_caps(base->srcpad)) {
    // Time stamps say when lights changed; a frame is there a period later at the latest.
    const bool live = gst_base_src_is_live(base);
    gst_query_set_latency(query, live, live ? source_of(base).period() : 0, GST_CLOCK_TIME_NONE);
    return TRUE;
  }
  return GST_BASE_SRC_CLASS(parent_class)->query(base, query);
}

void class_init(gpointer klass, gpointer) {
  parent_class = g_type_class_peek_parent(klass);
  auto* object = G_OBJECT_CLASS(klass);
  object->get_property = get_property;
  object->set_property = set_property;
  object->finalize = finalize;
  auto* element = GST_ELEMENT_CLASS(klass);
  element->change_state = change_state;
  element->set_context = set_context;
  gst_element_class_set_static_metadata(
      element, "Light stage test source", "Source/Video",
      "A camera that films a head on a virtual light stage, under what a light program or sACN "
      "packets say",
      "the gst-inverse authors");
  GstCaps* caps = inverse::pixel_caps();
  gst_element_class_add_pad_template(
      element, gst_pad_template_new("src", GST_PAD_SRC, GST_PAD_ALWAYS, caps));
  gst_caps_unref(caps);
  auto* base = GST_BASE_SRC_CLASS(klass);
  base->start = start;
  base->stop = stop;
  base->get_caps = get_caps;
  base->fixate = fixate;
  base->set_caps = set_caps;
  base->decide_allocation = decide_allocation;
  base->unlock = unlock;
  base->unlock_stop = unlock_stop;
  base->is_seekable = is_seekable;
  base->query = query;
  GST_PUSH_SRC_CLASS(klass)->create = create;
  g_object_class_install_property(
      object, PROP_DEVICE,
      g_param_spec_string(
          "device", "device",
          "Vulkan device: an index or a part of its name; empty = INVERSE_DEVICE, else the fastest",
          "",
          static_cast<GParamFlags>(G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
                                   GST_PARAM_MUTABLE_READY)));
  g_object_class_install_property(
      object, PROP_STATS,
      g_param_spec_boxed(
          "stats", "stats", "Times (ms), memory (bytes) and counts up to the last frame",
          GST_TYPE_STRUCTURE, static_cast<GParamFlags>(G_PARAM_READABLE | G_PARAM_STATIC_STRINGS)));
  g_object_class_install_property(
      object, PROP_LIVE,
      g_param_spec_boolean(
          "is-live", "is live",
          "Produce frames at the program's times, as a camera does; false = as fast as possible",
          TRUE,
          static_cast<GParamFlags>(G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
                                   GST_PARAM_MUTABLE_READY)));
  inverse::install_parameters(
      klass, inverse::Parameters<inverse::TestSourceParams>(inverse::test_source_properties()),
      PROP_TABLE);
}

void instance_init(GTypeInstance* instance, gpointer) {
  auto* self = reinterpret_cast<GstLightStageTestSrc*>(instance);
  self->source = new TestSource(GST_ELEMENT(instance));
  gst_base_src_set_format(GST_BASE_SRC(instance), GST_FORMAT_TIME);
  gst_base_src_set_live(GST_BASE_SRC(instance), TRUE);
}

}  // namespace

namespace inverse {

bool register_test_source(GstPlugin* plugin);

bool register_test_source(GstPlugin* plugin) {
  debug_category("lightstagetestsrc", "Light stage test source");
  GTypeInfo info{};
  info.class_size = sizeof(GstLightStageTestSrcClass);
  info.class_init = class_init;
  info.instance_size = sizeof(GstLightStageTestSrc);
  info.instance_init = instance_init;
  const GType type = g_type_register_static(GST_TYPE_PUSH_SRC, "GstLightStageTestSrc", &info,
                                            static_cast<GTypeFlags>(0));
  return gst_element_register(plugin, "lightstagetestsrc", GST_RANK_NONE, type);
}

}  // namespace inverse
