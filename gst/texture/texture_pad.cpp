// SPDX-License-Identifier: LGPL-2.1-or-later
#include "texture_pad.hpp"

#include "gst/base/frames/frame_io.hpp"
#include "gst/base/log/errors.hpp"

namespace inverse {
namespace {

TexturePad& self_of(GstPad* pad) {
  return *static_cast<TexturePad*>(gst_pad_get_element_private(pad));
}

}  // namespace

std::shared_ptr<TexturePad> TexturePad::create(GstElement* element, GstPadTemplate* pad_template) {
  GstPad* pad =
      gst_pad_new_from_template(pad_template, GST_PAD_TEMPLATE_NAME_TEMPLATE(pad_template));
  auto made = std::make_shared<TexturePad>(element, pad);
  gst_pad_set_element_private(pad, made.get());
  g_object_set_data_full(
      G_OBJECT(pad), "inverse-texture-pad", new std::shared_ptr<TexturePad>(made),
      [](gpointer kept) { delete static_cast<std::shared_ptr<TexturePad>*>(kept); });
  gst_pad_set_chain_function(
      pad, [](GstPad* own, GstObject*, GstBuffer* buffer) { return self_of(own).chain(buffer); });
  gst_pad_set_event_function(
      pad, [](GstPad* own, GstObject*, GstEvent* event) { return self_of(own).event(event); });
  gst_pad_set_query_function(
      pad, [](GstPad* own, GstObject*, GstQuery* query) { return self_of(own).query(query); });
  gst_pad_set_activatemode_function(pad, [](GstPad* own, GstObject*, GstPadMode, gboolean active) {
    self_of(own).set_flushing(!active);
    return gboolean{TRUE};
  });
  GstState state = GST_STATE_NULL;
  gst_element_get_state(element, &state, nullptr, 0);
  if (state > GST_STATE_READY) gst_pad_set_active(pad, TRUE);
  return made;
}

TexturePad::TexturePad(GstElement* element, GstPad* pad) : element_(element), pad_(pad) {
  gst_video_info_init(&info_);
  gst_segment_init(&segment_, GST_FORMAT_TIME);
}

void TexturePad::set_flushing(bool flushing) {
  const std::lock_guard lock(mutex_);
  flushing_ = flushing;
  if (flushing) waiting_.clear();
  taken_.notify_all();
}

bool TexturePad::set_caps(GstCaps* caps) {
  return guarded(element_, [&] {
    GstVideoInfo info;
    if (!gst_video_info_from_caps(&info, caps))
      throw Error(ErrorKind::unsupported, "the texture's caps are not those of raw video");
    frame_format(info);  // throws if kernels cannot read it
    info_ = info;
  });
}

GstFlowReturn TexturePad::chain(GstBuffer* buffer) {
  Frame frame{std::unique_ptr<GstBuffer, FreeBuffer>(buffer), info_,
              segment_.format == GST_FORMAT_TIME
                  ? gst_segment_to_running_time(&segment_, GST_FORMAT_TIME, GST_BUFFER_PTS(buffer))
                  : GST_CLOCK_TIME_NONE};
  if (is_gap(buffer)) return GST_FLOW_OK;
  if (GST_VIDEO_INFO_FORMAT(&info_) == GST_VIDEO_FORMAT_UNKNOWN) return GST_FLOW_NOT_NEGOTIATED;
  std::unique_lock lock(mutex_);
  taken_.wait(lock, [&] { return flushing_ || waiting_.size() < kMaxWaiting; });
  if (flushing_) return GST_FLOW_FLUSHING;
  waiting_.push_back(std::move(frame));
  return GST_FLOW_OK;
}

std::optional<TexturePad::Frame> TexturePad::take(GstClockTime now) {
  const std::lock_guard lock(mutex_);
  std::optional<Frame> newest;
  while (!waiting_.empty() &&
         (!GST_CLOCK_TIME_IS_VALID(now) || !GST_CLOCK_TIME_IS_VALID(waiting_.front().time) ||
          waiting_.front().time <= now)) {
    newest = std::move(waiting_.front());
    waiting_.pop_front();
    // Without times, one of its frames is used for one of the main stream.
    if (!GST_CLOCK_TIME_IS_VALID(now) || !GST_CLOCK_TIME_IS_VALID(newest->time)) break;
  }
  if (newest) taken_.notify_all();
  return newest;
}

gboolean TexturePad::event(GstEvent* event) {
  gboolean good = TRUE;
  switch (GST_EVENT_TYPE(event)) {
    case GST_EVENT_CAPS: {
      GstCaps* caps = nullptr;
      gst_event_parse_caps(event, &caps);
      good = set_caps(caps);
      break;
    }
    case GST_EVENT_SEGMENT:
      gst_event_copy_segment(event, &segment_);
      break;
    case GST_EVENT_FLUSH_START:
      set_flushing(true);
      break;
    case GST_EVENT_FLUSH_STOP:
      gst_segment_init(&segment_, GST_FORMAT_TIME);
      set_flushing(false);
      break;
    default:
      break;  // its end, its tags and so on are not those of the main stream
  }
  gst_event_unref(event);
  return good;
}

gboolean TexturePad::query(GstQuery* query) {
  // Others would be passed on to the main stream.
  switch (GST_QUERY_TYPE(query)) {
    case GST_QUERY_CAPS:
    case GST_QUERY_ACCEPT_CAPS:
      return gst_pad_query_default(pad_, GST_OBJECT(element_), query);
    case GST_QUERY_ALLOCATION:
      gst_query_add_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr);
      return TRUE;
    default:
      return FALSE;
  }
}

}  // namespace inverse
