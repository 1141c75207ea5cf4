// SPDX-License-Identifier: LGPL-2.1-or-later
#include "return_pad.hpp"

#include "gst/base/frames/frame_io.hpp"
#include "gst/base/log/log.hpp"
#include "gst/base/pads/pads.hpp"

namespace inverse {
namespace {

/// Pictures that may wait for their frame: a branch that is ahead of another one by more than that
/// has to wait itself.
constexpr size_t kMaxHeld = 64;

}  // namespace

std::shared_ptr<ReturnPad> ReturnPad::create(GstPadTemplate* pad_template, SplitLayer layer,
                                             const std::shared_ptr<Shared>& shared) {
  GstPad* pad =
      gst_pad_new_from_template(pad_template, GST_PAD_TEMPLATE_NAME_TEMPLATE(pad_template));
  auto made = std::make_shared<ReturnPad>(pad, layer, shared);
  gst_pad_set_element_private(pad, made.get());
  g_object_set_data_full(
      G_OBJECT(pad), "inverse-return-pad", new std::shared_ptr<ReturnPad>(made),
      [](gpointer kept) { delete static_cast<std::shared_ptr<ReturnPad>*>(kept); });
  gst_pad_set_activatemode_function(
      pad, [](GstPad* own, GstObject*, GstPadMode mode, gboolean active) -> gboolean {
        return mode == GST_PAD_MODE_PUSH && self_of(own).activate(active);
      });
  gst_pad_set_chain_function(
      pad, [](GstPad* own, GstObject*, GstBuffer* buffer) { return self_of(own).chain(buffer); });
  gst_pad_set_event_function(
      pad, [](GstPad* own, GstObject*, GstEvent* event) { return self_of(own).event(event); });
  gst_pad_set_query_function(pad, [](GstPad* own, GstObject* parent, GstQuery* query) -> gboolean {
    if (GST_QUERY_TYPE(query) != GST_QUERY_ALLOCATION)
      return gst_pad_query_default(own, parent, query);
    gst_query_add_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr);
    return TRUE;
  });
  return made;
}

ReturnPad::ReturnPad(GstPad* pad, SplitLayer layer, std::shared_ptr<Shared> shared)
    : pad_(pad), layer_(layer), shared_(std::move(shared)) {
  gst_segment_init(&segment_, GST_FORMAT_UNDEFINED);
}

ReturnPad& ReturnPad::self_of(GstPad* pad) {
  return *static_cast<ReturnPad*>(gst_pad_get_element_private(pad));
}

void ReturnPad::clear() {
  held_.clear();
  shared_->changed.notify_all();
}

void ReturnPad::set_flushing(bool flushing) {
  const std::lock_guard lock(shared_->mutex);
  flushing_ = flushing;
  ended_ = false;
  gst_segment_init(&segment_, GST_FORMAT_UNDEFINED);
  clear();
}

bool ReturnPad::activate(bool active) {
  set_flushing(!active);
  if (!active) return true;
  const std::lock_guard lock(shared_->mutex);
  stalled = unresponsive = warned = came = false;
  absent = 0;
  sent_.reset();
  format_.reset();
  return true;
}

ReturnPad::Time ReturnPad::running_time(GstClockTime time) const {
  if (segment_.format != GST_FORMAT_TIME || !GST_CLOCK_TIME_IS_VALID(time)) return {};
  guint64 running = 0;
  const int sign = gst_segment_to_running_time_full(&segment_, GST_FORMAT_TIME, time, &running);
  if (sign == 0) return {};
  return sign * static_cast<GstClockTimeDiff>(running);
}

GstFlowReturn ReturnPad::chain(GstBuffer* buffer) {
  const std::shared_ptr<GstBuffer> owned(buffer, gst_buffer_unref);
  std::unique_lock lock(shared_->mutex);
  shared_->changed.wait(lock,
                        [&] { return flushing_ || shared_->ended || held_.size() < kMaxHeld; });
  if (flushing_) return GST_FLOW_FLUSHING;
  if (ended_) return GST_FLOW_EOS;
  if (!format_) return GST_FLOW_NOT_NEGOTIATED;
  if (shared_->ended || is_gap(buffer)) return GST_FLOW_OK;
  held_.push_back({running_time(GST_BUFFER_PTS(buffer)), {}, owned, format_});
  unresponsive = false;
  shared_->changed.notify_all();
  return GST_FLOW_OK;
}

gboolean ReturnPad::event(GstEvent* event) {
  const ElementPtr element = element_of_pad(pad_);
  GST_CAT_DEBUG_OBJECT(log_of(element.get()).category, pad_, "event: %" GST_PTR_FORMAT, event);
  bool good = true;
  switch (GST_EVENT_TYPE(event)) {
    case GST_EVENT_CAPS: {
      GstCaps* caps = nullptr;
      gst_event_parse_caps(event, &caps);
      good = set_caps(caps);
      break;
    }
    case GST_EVENT_SEGMENT: {
      const std::lock_guard lock(shared_->mutex);
      gst_event_copy_segment(event, &segment_);
      break;
    }
    case GST_EVENT_GAP:
      hold_gap(event);
      break;
    case GST_EVENT_FLUSH_START:
    case GST_EVENT_FLUSH_STOP:
      set_flushing(GST_EVENT_TYPE(event) == GST_EVENT_FLUSH_START);
      break;
    case GST_EVENT_STREAM_START:
    case GST_EVENT_EOS: {
      const std::lock_guard lock(shared_->mutex);
      ended_ = GST_EVENT_TYPE(event) == GST_EVENT_EOS;
      shared_->changed.notify_all();
      break;
    }
    case GST_EVENT_CUSTOM_DOWNSTREAM_STICKY:
      if (const auto sent = SentPicture::of(event)) describe(*sent);
      break;
    default:
      break;
  }
  gst_event_unref(event);
  return good;
}

bool ReturnPad::set_caps(GstCaps* caps) {
  const std::lock_guard lock(shared_->mutex);
  if (!gst_video_info_from_caps(&info_, caps)) return false;
  color_is_open_ = !gst_structure_has_field(gst_caps_get_structure(caps, 0), "colorimetry");
  auto format = std::make_shared<ReturnedFormat>();
  // Without a word of how they were sent, pictures are taken for what intrinsicsplit sends by
  // default in these caps.
  format->sent = sent_.value_or(SentPicture{layer_, info_, info_.colorimetry.primaries, {}, false});
  format->info = info_;
  // Effects that do not know of color leave it out.
  const GstVideoInfo& was = format->sent.info;
  if (color_is_open_ && GST_VIDEO_INFO_FORMAT(&was) == GST_VIDEO_INFO_FORMAT(&info_)) {
    format->info.colorimetry = was.colorimetry;
    format->info.chroma_site = was.chroma_site;
  }
  if (info_.chroma_site == GST_VIDEO_CHROMA_SITE_UNKNOWN)
    format->info.chroma_site = was.chroma_site;
  format_ = std::move(format);
  return true;
}

void ReturnPad::describe(const SentPicture& sent) {
  {
    const std::lock_guard lock(shared_->mutex);
    sent_ = sent;
  }
  if (GstCaps* caps = gst_pad_get_current_caps(pad_)) {
    set_caps(caps);
    gst_caps_unref(caps);
  }
}

void ReturnPad::hold_gap(GstEvent* event) {
  GstClockTime start = 0, duration = 0;
  gst_event_parse_gap(event, &start, &duration);
  const std::lock_guard lock(shared_->mutex);
  const Time from = running_time(start);
  if (!from || shared_->ended) return;
  const auto length =
      GST_CLOCK_TIME_IS_VALID(duration) ? static_cast<GstClockTimeDiff>(duration) : 0;
  held_.push_back({from, *from + length, nullptr, nullptr});
  shared_->changed.notify_all();
}

ReturnPad::Found ReturnPad::take(Time time, GstClockTimeDiff tolerance, Picture& picture) {
  while (!held_.empty()) {
    Picture& first = held_.front();
    const bool gap = !first.buffer;
    const bool timed = time && first.start;
    if (timed && *first.start > *time + tolerance) return Found::none;  // of a later frame
    const bool over =
        timed && *first.start < *time - tolerance && (!gap || *first.end <= *time + tolerance);
    if (gap && !over) return Found::none;
    picture = std::move(first);
    held_.pop_front();
    shared_->changed.notify_all();
    if (!over) return Found::picture;
    if (!gap) ++shared_->late;
  }
  return ended_ || flushing_ || !gst_pad_is_linked(pad_) ? Found::none : Found::nothing_yet;
}

}  // namespace inverse
