// SPDX-License-Identifier: LGPL-2.1-or-later
// rgbdtestsrc: a camera with depth that moves through a room.
#include <gst/base/gstpushsrc.h>

#include "gst/base/device_source.hpp"
#include "gst/base/log/errors.hpp"
#include "gst/base/log/log.hpp"
#include "gst/base/pads/caps.hpp"
#include "room_source.hpp"

using inverse::RoomSource;

struct GstRgbdTestSrc {
  GstPushSrc parent;
  RoomSource* body;
  // Of the streaming thread.
  GstVideoInfo info;
  gint64 frame;  // the next one, counted from running time 0
};

namespace {

using Class = inverse::ElementClass<GstRgbdTestSrc>;
using Source = inverse::DeviceSource<Class>;
constexpr gint kWidth = 320, kHeight = 240, kRate = 30;

GstRgbdTestSrc& self_of(gpointer object) { return *static_cast<GstRgbdTestSrc*>(object); }
RoomSource& source_of(gpointer object) { return Class::body_of(object); }

gboolean start(GstBaseSrc* base) {
  self_of(base).frame = 0;
  return inverse::check_parameters(inverse::log_of(GST_ELEMENT(base)),
                                   source_of(base).parameters()) &&
         inverse::guarded(GST_ELEMENT(base), [&] {
           source_of(base).context().renew(source_of(base).params().device);
         });
}

gboolean stop(GstBaseSrc* base) {
  source_of(base).stop();
  return TRUE;
}

GstCaps* fixate(GstBaseSrc* base, GstCaps* caps) {
  caps = gst_caps_make_writable(gst_caps_truncate(caps));
  gst_structure_fixate_field_nearest_fraction(gst_caps_get_structure(caps, 0), "framerate", kRate,
                                              1);
  return Source::fixate(base, caps, kWidth, kHeight);
}

gboolean set_caps(GstBaseSrc* base, GstCaps* caps) {
  const inverse::Log log = inverse::log_of(GST_ELEMENT(base));
  GST_CAT_INFO_OBJECT(log.category, base, "caps: %" GST_PTR_FORMAT, caps);
  return inverse::guarded(GST_ELEMENT(base), [&] {
    GstVideoInfo info;
    if (!gst_video_info_from_caps(&info, caps) || GST_VIDEO_INFO_FPS_N(&info) <= 0)
      throw inverse::Error(inverse::ErrorKind::unsupported,
                           "rgbdtestsrc was asked for an impossible video format; it needs a size "
                           "and a frame rate");
    gst_base_src_set_blocksize(base, static_cast<guint>(GST_VIDEO_INFO_SIZE(&info)));
    source_of(base).set_caps(info);
    self_of(base).info = info;
  });
}

GstClockTime time_of(const GstRgbdTestSrc& self, gint64 frame) {
  return gst_util_uint64_scale(static_cast<guint64>(frame),
                               GST_SECOND * static_cast<guint64>(GST_VIDEO_INFO_FPS_D(&self.info)),
                               static_cast<guint64>(GST_VIDEO_INFO_FPS_N(&self.info)));
}

gboolean do_seek(GstBaseSrc* base, GstSegment* segment) {
  auto& self = self_of(base);
  segment->time = segment->start;
  self.frame = GST_VIDEO_INFO_FPS_N(&self.info) > 0
                   ? static_cast<gint64>(gst_util_uint64_scale(
                         segment->position, static_cast<guint64>(GST_VIDEO_INFO_FPS_N(&self.info)),
                         GST_SECOND * static_cast<guint64>(GST_VIDEO_INFO_FPS_D(&self.info))))
                   : 0;
  return segment->rate > 0;
}

gboolean is_seekable(GstBaseSrc* base) { return !gst_base_src_is_live(base); }

/// A live frame is due at its time stamp.
void get_times(GstBaseSrc* base, GstBuffer* buffer, GstClockTime* start, GstClockTime* end) {
  *start = *end = GST_CLOCK_TIME_NONE;
  if (!gst_base_src_is_live(base) || !GST_BUFFER_PTS_IS_VALID(buffer)) return;
  *start = GST_BUFFER_PTS(buffer);
  *end = *start + GST_BUFFER_DURATION(buffer);
}

GstFlowReturn create(GstPushSrc* push, GstBuffer** buffer) {
  auto& self = self_of(push);
  auto* base = GST_BASE_SRC(push);
  const GstClockTime time = time_of(self, self.frame);
  gst_object_sync_values(GST_OBJECT(push), time);
  GstBuffer* made = nullptr;
  const GstFlowReturn allocated = GST_BASE_SRC_CLASS(Class::parent_class)
                                      ->alloc(base, 0, gst_base_src_get_blocksize(base), &made);
  if (allocated != GST_FLOW_OK) return allocated;
  if (!inverse::guarded(GST_ELEMENT(push), [&] {
        source_of(push).draw(static_cast<double>(time) / GST_SECOND,
                             static_cast<uint64_t>(self.frame), made);
      })) {
    gst_buffer_unref(made);
    return GST_FLOW_ERROR;
  }
  GST_BUFFER_PTS(made) = time;
  GST_BUFFER_DTS(made) = GST_CLOCK_TIME_NONE;
  GST_BUFFER_DURATION(made) = time_of(self, self.frame + 1) - time;
  GST_BUFFER_OFFSET(made) = static_cast<guint64>(self.frame);
  GST_BUFFER_OFFSET_END(made) = static_cast<guint64>(self.frame) + 1;
  GST_CAT_LOG_OBJECT(inverse::log_of(GST_ELEMENT(push)).category, push,
                     "frame %" G_GINT64_FORMAT ": %" GST_PTR_FORMAT, self.frame, made);
  ++self.frame;
  *buffer = made;
  return GST_FLOW_OK;
}

gboolean query(GstBaseSrc* base, GstQuery* query) {
  // A live frame is drawn before it is due, and may take as long as it lasts.
  return Source::query(base, query, [base] { return time_of(self_of(base), 1); });
}

void class_init(GstElementClass* element) {
  Source::class_init(element);
  auto* base = GST_BASE_SRC_CLASS(element);
  base->start = start;
  base->stop = stop;
  base->fixate = fixate;
  base->set_caps = set_caps;
  base->do_seek = do_seek;
  base->is_seekable = is_seekable;
  base->get_times = get_times;
  base->query = query;
  GST_PUSH_SRC_CLASS(element)->create = create;
  Class::install_properties(element, "Times (ms) and memory (bytes) of the last frame",
                            inverse::room_source_properties());
}

void instance_init(GstRgbdTestSrc* self) {
  self->body = new RoomSource(GST_ELEMENT(self));
  gst_video_info_init(&self->info);
  gst_base_src_set_format(GST_BASE_SRC(self), GST_FORMAT_TIME);
}

constexpr Class kClass{"rgbdtestsrc",
                       "GstRgbdTestSrc",
                       "RGB-D test source",
                       "Source/Video",
                       "Simulates a camera with depth that moves through a furnished room",
                       gst_push_src_get_type,
                       class_init,
                       instance_init};

}  // namespace

namespace inverse {

gboolean register_rgbdtestsrc(GstPlugin* plugin);
gboolean register_rgbdtestsrc(GstPlugin* plugin) { return kClass.register_element(plugin); }

}  // namespace inverse
