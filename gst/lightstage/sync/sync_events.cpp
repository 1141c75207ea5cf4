// SPDX-License-Identifier: LGPL-2.1-or-later
// Events and queries of lightstagesync's pads.
#include <cmath>

#include "gst/base/log/errors.hpp"
#include "gst/base/pads/caps.hpp"
#include "gst/base/report.hpp"
#include "gst/lightstage/sync/assemble/olat_assembler.hpp"
#include "sync_element.hpp"

namespace inverse {
namespace {

constexpr double kSameRate = 1e-3;  // of the program's

}  // namespace

/// With the mutex locked.
void SyncElement::start_stream(SyncCamera& camera, GstEvent* event) {
  const gchar* id = nullptr;
  gst_event_parse_stream_start(event, &id);
  const std::string name = id ? id : "";
  const bool another = camera.ended || (!camera.stream_id.empty() && camera.stream_id != name);
  camera.stream_id = name;
  if (another) {
    // Another recording has another clock, and its own start of the program.
    labeled(camera, camera.labeler->drain());
    camera.labeler->reset();
    end_program(camera, false);
  }
  if (!camera.ended) return;
  camera.ended = false;
  lacked_ended_ = 0;
  sets_.wait_for(camera.number, true);
  gst_pad_start_task(camera.src, push_task, camera.src, nullptr);
}

/// The sink pad's thread hears of caps.
bool SyncElement::set_caps(SyncCamera& camera, GstCaps* caps) {
  GstVideoInfo info;
  if (!gst_video_info_from_caps(&info, caps)) {
    GST_ELEMENT_ERROR(element_, STREAM, FORMAT,
                      ("lightstagesync cannot make sense of the video format"),
                      ("got %" GST_PTR_FORMAT, caps));
    return false;
  }
  const bool other_picture =
      camera.info && (GST_VIDEO_INFO_WIDTH(&*camera.info) != GST_VIDEO_INFO_WIDTH(&info) ||
                      GST_VIDEO_INFO_HEIGHT(&*camera.info) != GST_VIDEO_INFO_HEIGHT(&info) ||
                      GST_VIDEO_INFO_FORMAT(&*camera.info) != GST_VIDEO_INFO_FORMAT(&info));
  camera.info = info;
  camera.linear.emplace(info);
  Lock lock(mutex_);
  if (other_picture && camera.labeler) {
    labeled(camera, camera.labeler->new_framing());
    advance();
    post(lock);
  }
  camera.frame_bytes = GST_VIDEO_INFO_SIZE(&info);
  camera.begun = true;
  camera.last_arrival = Clock::now();
  if (!labels_) return true;
  if (const auto trigger = trigger_) {
    lock.unlock();  // it communicates with the camera
    return guarded(element_, [&] { trigger->camera_ready(camera.number); });
  }
  const LightProgram& program = labels_->program();
  const double rate = double(program.rate_numerator) / program.rate_denominator;
  const int num = GST_VIDEO_INFO_FPS_N(&info), den = GST_VIDEO_INFO_FPS_D(&info);
  // 0 means that the camera is triggered.
  if (num > 0 && den > 0 && std::abs(double(num) / den / rate - 1) > kSameRate)
    warn("camera " + camera.name() + " reports " + std::to_string(double(num) / den) +
         " frames a second, the light program " + std::to_string(rate) +
         " steps; labels need one frame a step: set the camera's rate, or " +
         (is_built_in_program(params_.program) ? "lightstagesync's property \"rate\""
                                               : "\"rate\" in " + params_.program));
  post(lock);
  return true;
}

gboolean SyncElement::sink_event(const CameraPtr& camera, GstEvent* event) {
  switch (GST_EVENT_TYPE(event)) {
    case GST_EVENT_FLUSH_START: {
      {
        Lock lock(mutex_);
        camera->flushing = true;
        changed_.notify_all();
      }
      const gboolean good = gst_pad_push_event(camera->src, event);
      gst_pad_pause_task(camera->src);
      return good;
    }
    case GST_EVENT_FLUSH_STOP: {
      {
        // The thread of the pad has stopped: its item has no owner.
        Lock lock(mutex_);
        if (camera->released) {
          gst_event_unref(event);
          return FALSE;
        }
        camera->clear();
        if (camera->assembler) camera->assembler->forget();
        if (camera->labeler) camera->labeler->flush();
        if (labels_) sets_.forget_frames(camera->number);
        if (labels_) sets_.wait_for(camera->number, true);
        camera->last_trigger.reset();
        camera->ended = camera->left_alone = false;
        lacked_ended_ = 0;
        camera->flow = GST_FLOW_OK;
        camera->last_arrival = Clock::now();
      }
      const gboolean good = gst_pad_push_event(camera->src, event);
      activate_src(camera, true);
      return good;
    }
    case GST_EVENT_CAPS: {
      GstCaps* caps = nullptr;
      gst_event_parse_caps(event, &caps);
      if (!set_caps(*camera, caps)) {
        gst_event_unref(event);
        return FALSE;
      }
      break;
    }
    case GST_EVENT_SEGMENT:
      gst_event_copy_segment(event, &camera->segment);
      break;
    default:
      break;
  }
  const bool in_order = gst_event_type_get_flags(GST_EVENT_TYPE(event)) & GST_EVENT_TYPE_SERIALIZED;
  if (!in_order) return gst_pad_push_event(camera->src, event);
  Lock lock(mutex_);
  if (camera->flushing) {
    gst_event_unref(event);
    return FALSE;
  }
  if (GST_EVENT_TYPE(event) == GST_EVENT_STREAM_START) {
    if (camera->labeler) start_stream(*camera, event);
  }
  if (GST_EVENT_TYPE(event) == GST_EVENT_EOS && camera->labeler) {
    labeled(*camera, camera->labeler->drain());
    camera->reported_at = {};  // the last losses, too
    report(*camera);
    camera->ended = true;
    sets_.wait_for(camera->number, false);
    if (camera->labeler->counts().markers == 0 && camera->labeler->counts().frames > 0 &&
        labels_->program().marker != LightProgram::Marker::none)
      warn("camera " + camera->name() +
           " has ended without the marker of the light program "
           "(black, full on, black): none of its frames has a label");
    post(lock);  // before an application that waits for the end hears of it
  }
  camera->append(event);
  advance();
  post(lock);
  return TRUE;
}

/// A serialized query, such as a drain: behind all frames that came before it. Those that wait for
/// later ones to confirm their labels are decided, as at the end of a stream. If frames of other
/// cameras do not come within the timeout, it fails and is not passed on.
gboolean SyncElement::query_in_line(SyncCamera& camera, GstQuery* query) {
  Lock lock(mutex_);
  if (camera.flushing || camera.ended || !camera.labeler) return FALSE;
  labeled(camera, camera.labeler->drain());
  camera.query = query;
  camera.append(query);
  advance();
  const auto until = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                        std::chrono::duration<double>(frame_timeout()));
  camera.blocked = true;
  while (camera.query) {
    if ((camera.flushing || Clock::now() > until) && camera.take_back(query)) {
      camera.query = nullptr;
      camera.answer = false;
      break;
    }
    changed_.wait_for(lock, kCheckEvery);
    report_stalled_cameras();
    post(lock);
  }
  camera.blocked = false;
  camera.last_arrival = Clock::now();
  return camera.answer;
}

/// The source pad's thread.
void SyncElement::answer(SyncCamera& camera, GstQuery* query) {
  bool good = true;
  if (GST_QUERY_TYPE(query) == GST_QUERY_DRAIN)
    good = guarded(element_, [&] { camera.assembler->return_buffers(); });
  good = good && gst_pad_peer_query(camera.src, query);
  Lock lock(mutex_);
  camera.query = nullptr;
  camera.answer = good;
  changed_.notify_all();
}

gboolean SyncElement::sink_query(const CameraPtr& camera, GstQuery* query) {
  switch (GST_QUERY_TYPE(query)) {
    case GST_QUERY_CAPS: {
      GstCaps *filter = nullptr, *caps = gst_pad_get_pad_template_caps(camera->sink);
      gst_query_parse_caps(query, &filter);
      SyncParams::Assemble assemble = parameters_.snapshot().assemble;
      if (assemble != SyncParams::Assemble::pairs) {
        GstCaps* taken = gst_pad_peer_query_caps(camera->src, caps);
        gst_caps_unref(caps);
        caps = taken;
      }
      caps = filter_caps(caps, filter);
      gst_query_set_caps_result(query, caps);
      gst_caps_unref(caps);
      return TRUE;
    }
    case GST_QUERY_ALLOCATION:
      // Frames wait here: a pool of downstream would run dry.
      return FALSE;
    default:
      return gst_query_type_get_flags(GST_QUERY_TYPE(query)) & GST_QUERY_TYPE_SERIALIZED
                 ? query_in_line(*camera, query)
                 : gst_pad_query_default(camera->sink, GST_OBJECT(element_), query);
  }
}

/// Max number of steps that a frame waits for the other of its pair or the rest of its pass, and
/// for the picture that confirms its label.
uint64_t SyncElement::max_steps() const {
  uint64_t steps = 0;
  if (params_.assemble == SyncParams::Assemble::pairs) steps += 1;
  if (params_.assemble == SyncParams::Assemble::olat)
    steps += OlatAssembler::longest_pass(labels_->program());
  if (!trigger_) steps += FrameLabeler::longest_wait(labels_->program(), labeler_params());
  return steps;
}

/// Max time of a frame in the element: for the others of its set, and these steps.
GstClockTime SyncElement::own_latency() const {
  GstClockTime latency = 0;
  if (cameras_.size() > 1) latency += static_cast<GstClockTime>(params_.timeout * GST_SECOND);
  return labels_ ? latency + max_steps_ * labels_->period() : latency;
}

gboolean SyncElement::src_event(const CameraPtr& camera, GstEvent* event) {
  if (GST_EVENT_TYPE(event) == GST_EVENT_LATENCY) {
    Lock lock(mutex_);
    GstClockTime latency = 0;
    gst_event_parse_latency(event, &latency);
    camera->sinks_wait = GST_CLOCK_TIME_IS_VALID(latency) ? latency : 0;
    changed_.notify_all();
  }
  return gst_pad_event_default(camera->src, GST_OBJECT(element_), event);
}

gboolean SyncElement::src_query(const CameraPtr& camera, GstQuery* query) {
  switch (GST_QUERY_TYPE(query)) {
    case GST_QUERY_CAPS: {
      GstCaps *filter = nullptr, *in = gst_pad_get_current_caps(camera->sink);
      gst_query_parse_caps(query, &filter);
      if (!in) {
        GstCaps* ours = gst_pad_get_pad_template_caps(camera->sink);
        in = gst_pad_peer_query_caps(camera->sink, ours);
        gst_caps_unref(ours);
      }
      GstCaps* caps = assembled_caps(in, parameters_.snapshot().assemble);
      gst_caps_unref(in);
      caps = filter_caps(caps, filter);
      gst_query_set_caps_result(query, caps);
      gst_caps_unref(caps);
      return TRUE;
    }
    case GST_QUERY_CONTEXT:
      return context_.answer(query) ||
             gst_pad_query_default(camera->src, GST_OBJECT(element_), query) ||
             context_.provide(query);
    case GST_QUERY_LATENCY: {
      // All go on together: the slowest camera's latency is everybody's.
      std::vector<GstPad*> sinks;
      GstClockTime ours = 0;
      {
        std::lock_guard lock(mutex_);
        ours = own_latency();
        for (const auto& [number, one] : cameras_)
          sinks.push_back(GST_PAD(gst_object_ref(one->sink)));
      }
      gboolean live = FALSE, any = FALSE;
      GstClockTime min_latency = 0, max_latency = GST_CLOCK_TIME_NONE;
      for (GstPad* sink : sinks) {
        GstQuery* peer = gst_query_new_latency();
        gboolean is_live = FALSE;
        GstClockTime low = 0, high = 0;
        if (gst_pad_peer_query(sink, peer)) {
          any = TRUE;
          gst_query_parse_latency(peer, &is_live, &low, &high);
          if (is_live) {
            live = TRUE;
            min_latency = MAX(min_latency, low);
            max_latency = MIN(max_latency, high);  // none is the largest
          }
        }
        gst_query_unref(peer);
        gst_object_unref(sink);
      }
      if (!any) return FALSE;
      gst_query_set_latency(query, live, min_latency, live ? max_latency : GST_CLOCK_TIME_NONE);
      add_latency(query, ours);
      return TRUE;
    }
    default:
      return gst_pad_query_default(camera->src, GST_OBJECT(element_), query);
  }
}

}  // namespace inverse
