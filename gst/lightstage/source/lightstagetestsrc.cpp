// SPDX-License-Identifier: LGPL-2.1-or-later
// lightstagetestsrc: a camera with a view of a head on a virtual light stage.
#include <gst/base/gstpushsrc.h>

#include <algorithm>

#include "gst/base/device_source.hpp"
#include "gst/base/log/errors.hpp"
#include "gst/base/log/log.hpp"
#include "gst/base/pads/caps.hpp"
#include "test_source.hpp"

using inverse::TestSource;

struct GstLightStageTestSrc {
  GstPushSrc parent;
  TestSource* body;
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

namespace {

using Class = inverse::ElementClass<GstLightStageTestSrc>;
using Source = inverse::DeviceSource<Class>;
constexpr gint kWidth = 320, kHeight = 240;

GstLightStageTestSrc& self_of(gpointer object) {
  return *static_cast<GstLightStageTestSrc*>(object);
}
TestSource& source_of(gpointer object) { return Class::body_of(object); }

gboolean start(GstBaseSrc* base) {
  auto& self = self_of(base);
  std::string trouble;
  if (!inverse::check_parameters(inverse::log_of(GST_ELEMENT(base)), self.body->parameters()))
    return FALSE;
  if (!inverse::guarded(GST_ELEMENT(base), [&] { trouble = self.body->start(); })) return FALSE;
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
  self.body->stop();
  return TRUE;
}

GstCaps* get_caps(GstBaseSrc* base, GstCaps* filter) {
  // Before the start any caps do; afterwards the program's.
  return inverse::filter_caps(source_of(base).caps(), filter);
}

GstCaps* fixate(GstBaseSrc* base, GstCaps* caps) {
  return Source::fixate(base, caps, kWidth, kHeight);
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
  return GST_BASE_SRC_CLASS(Class::parent_class)->decide_allocation(base, query);
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
      self.frame = gst_util_uint64_scale_ceil(now, 1, self.body->period());
  }
  self.first = self.frame;
  self.start = self.body->said_start().value_or(self.first);
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
  while (self.body->time_of(self.frame + lost + kBuffers) < now) ++lost;
  if (lost) self.body->overran(lost);
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
  TestSource& source = *self.body;
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
  const GstFlowReturn allocated = GST_BASE_SRC_CLASS(Class::parent_class)
                                      ->alloc(base, 0, gst_base_src_get_blocksize(base), &made);
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
  // Time stamps say when lights changed; a frame is there a period later at the latest.
  return Source::query(base, query, [base] { return source_of(base).period(); });
}

void class_init(GstElementClass* element) {
  Source::class_init(element);
  auto* base = GST_BASE_SRC_CLASS(element);
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
  GST_PUSH_SRC_CLASS(element)->create = create;
  Class::install_properties(element, "Times (ms), memory (bytes) and counts up to the last frame",
                            inverse::test_source_properties());
}

void instance_init(GstLightStageTestSrc* self) {
  self->body = new TestSource(GST_ELEMENT(self));
  gst_base_src_set_format(GST_BASE_SRC(self), GST_FORMAT_TIME);
}

constexpr Class kClass{
    "lightstagetestsrc",
    "GstLightStageTestSrc",
    "Light stage test source",
    "Source/Video",
    "Simulates a camera on a virtual light stage, lit by a light program or by sACN",
    gst_push_src_get_type,
    class_init,
    instance_init};

}  // namespace

namespace inverse {

gboolean register_lightstagetestsrc(GstPlugin* plugin);
gboolean register_lightstagetestsrc(GstPlugin* plugin) { return kClass.register_element(plugin); }

}  // namespace inverse
