// SPDX-License-Identifier: LGPL-2.1-or-later
// The camera of lightstagearavissrc, from its opening to its end.
#include "aravis_source.hpp"

#include <algorithm>
#include <chrono>

#include "common/error.hpp"
#include "gst/base/log/log.hpp"

namespace inverse {
namespace {

void add(AravisStream::Counts* sum, const AravisStream::Counts& more) {
  sum->incomplete += more.incomplete;
  sum->misfits += more.misfits;
  sum->stale += more.stale;
  sum->copied += more.copied;
  sum->lent += more.lent;
  sum->underruns += more.underruns;
  sum->resent_packets += more.resent_packets;
  sum->missing_packets += more.missing_packets;
}

/// Running time now; −1 without a clock.
int64_t running_time(GstElement* element) {
  GstClock* clock = gst_element_get_clock(element);
  if (!clock) return -1;
  const auto now = static_cast<int64_t>(gst_clock_get_time(clock) - element->base_time);
  gst_object_unref(clock);
  return now;
}

}  // namespace

GstStructure* AravisSource::stats() {
  const Lock lock(mutex);
  AravisStream::Counts counts = before_;
  if (stream) add(&counts, stream->counts());
  return gst_structure_new(
      "lightstagearavissrc", "frames", G_TYPE_UINT64, frames_, "incomplete", G_TYPE_UINT64,
      counts.incomplete, "missed", G_TYPE_UINT64, missed_, "timeouts", G_TYPE_UINT64, timeouts_,
      "underruns", G_TYPE_UINT64, counts.underruns, "misfits", G_TYPE_UINT64, counts.misfits,
      "stale", G_TYPE_UINT64, counts.stale, "zero-copy", G_TYPE_UINT64, counts.lent, "copied",
      G_TYPE_UINT64, counts.copied, "held", G_TYPE_UINT, stream ? stream->lent_now() : 0U,
      "resent-packets", G_TYPE_UINT64, counts.resent_packets, "missing-packets", G_TYPE_UINT64,
      counts.missing_packets, "clock-jumps", G_TYPE_UINT64, clock_.jumps(), "clock-correction-ppm",
      G_TYPE_DOUBLE, clock_.correction_ppm(), nullptr);
}

void AravisSource::open() {
  std::string name;
  {
    const Lock lock(mutex);
    name = camera_name;
    flushing_ = lost_ = false;
  }
  auto opened = std::make_shared<AravisCamera>(name, [kept = shared_from_this()] {
    const Lock lock(kept->mutex);
    kept->lost_ = true;
    kept->changed.notify_all();
  });
  const uint32_t bits = opened->frame_id_bits();
  GstCaps* reference = opened->has_shared_clock()
                           ? gst_caps_new_simple("timestamp/x-ptp", "version", G_TYPE_STRING,
                                                 "IEEE1588-2008", "domain", G_TYPE_INT, 0, nullptr)
                           : gst_caps_new_simple("timestamp/x-camera", "camera", G_TYPE_STRING,
                                                 opened->name().c_str(), nullptr);
  const Lock lock(mutex);
  camera = std::move(opened);
  reference_ = reference;
  id_bits = bits;
  before_ = {};
  frames_ = missed_ = timeouts_ = reported_ = 0;
  clock_.reset();
  ids_ = FrameIds(bits);
}

void AravisSource::close() {
  end();
  std::shared_ptr<AravisCamera> closed;  // freed after the lock: that joins threads that lock it
  const Lock lock(mutex);
  closed = std::move(camera);
  id_bits = 0;
  gst_clear_caps(&reference_);
}

void AravisSource::end() {
  std::unique_ptr<AravisStream> ended;
  std::shared_ptr<AravisCamera> sender;
  bool lost;
  {
    const Lock lock(mutex);
    ended = std::move(stream);
    sender = camera;
    lost = lost_;
    if (ended) add(&before_, ended->counts());
  }
  // A lost camera does not answer.
  if (sender && !lost) sender->stop();
}

std::pair<std::shared_ptr<AravisCamera>, bool> AravisSource::opened() {
  const Lock lock(mutex);
  return {camera, !settings.trigger_source.empty()};
}

void AravisSource::begin(const GstCaps* caps) {
  std::shared_ptr<AravisCamera> sender;
  CameraSettings wanted;
  guint count;
  {
    const Lock lock(mutex);
    sender = camera;
    wanted = settings;
    count = buffers;
  }
  if (!sender) throw Error(ErrorKind::internal, "caps before the camera is open");
  if (wanted.exposure >= 0) sender->set_exposure(wanted.exposure);
  if (wanted.gain >= 0) sender->set_gain(wanted.gain);
  const FrameLayout agreed = sender->configure(caps, wanted);
  auto begun = std::make_unique<AravisStream>(*sender, agreed, count, [this] {
    const Lock lock(mutex);
    changed.notify_all();
  });
  {
    const Lock lock(mutex);
    layout = agreed;
    stream = std::move(begun);
  }
  sender->start();
}

void AravisSource::set_flushing(bool flush) {
  const Lock lock(mutex);
  flushing_ = flush;
  changed.notify_all();
}

/// A frame without a time of its own gets that of its arrival.
GstBuffer* AravisSource::finish(GstElement* element, const CameraFrame& frame, int64_t now) {
  const int64_t arrival = std::max<int64_t>(now - frame.age, 0);
  GstBuffer* buffer = frame.pixels;
  if (now >= 0) {
    const int64_t time = frame.camera_time ? clock_.map(frame.camera_time, arrival) : arrival;
    GST_BUFFER_PTS(buffer) = static_cast<GstClockTime>(time);
  }
  if (layout.frame_rate > 0)
    GST_BUFFER_DURATION(buffer) = static_cast<GstClockTime>(GST_SECOND / layout.frame_rate + 0.5);
  GST_BUFFER_OFFSET(buffer) = frame.id;
  GST_BUFFER_OFFSET_END(buffer) = GST_BUFFER_OFFSET_NONE;
  if (frame.camera_time)
    gst_buffer_add_reference_timestamp_meta(buffer, reference_, frame.camera_time,
                                            GST_CLOCK_TIME_NONE);
  if (id_bits < 64 && frame.id > 65535) {  // it has more bits than expected
    id_bits = 64;
    ids_ = FrameIds(64);
  }
  const uint64_t missed = ids_.missed_before(frame.id);
  missed_ += missed;
  ++frames_;
  if (missed)
    GST_CAT_INFO_OBJECT(log_of(GST_ELEMENT(element)).category, element,
                        "%" G_GUINT64_FORMAT " frames missing before number %" G_GUINT64_FORMAT,
                        missed, frame.id);
  GST_CAT_LOG_OBJECT(log_of(element).category, element,
                     "frame %" G_GUINT64_FORMAT ": %" GST_PTR_FORMAT, frame.id, buffer);
  return buffer;
}

/// Warns of frames that were lost in transfer, and again after ten times as many.
void AravisSource::report_incomplete(GstElement* element, Lock& lock) {
  const auto counts = stream->counts();
  const uint64_t bad = before_.incomplete + counts.incomplete + counts.misfits;
  // The first one may be: Aravis allocates buffers of the frames' size after it.
  if (bad < std::max<uint64_t>(reported_, 2)) return;
  reported_ = 10 * bad;
  const uint64_t good = frames_;
  lock.unlock();
  post_warning(log_of(element), GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_READ,
               "%" G_GUINT64_FORMAT
               " frames of the camera %s did not come whole (%" G_GUINT64_FORMAT
               " did); lower the frame rate or the size, or raise net.core.rmem_max and the packet "
               "size",
               bad, camera->name().c_str(), good);
  lock.lock();
}

GstFlowReturn AravisSource::next(GstElement* element, GstBuffer** buffer) {
  using Time = std::chrono::steady_clock;
  Lock lock(mutex);
  const std::string name = camera ? camera->name() : "";
  const auto began = Time::now();
  auto quiet_since = began;
  for (;;) {
    if (flushing_) return GST_FLOW_FLUSHING;
    if (lost_ || !stream)
      throw Error(ErrorKind::connection,
                  "the camera " + name +
                      " does not answer any more: check its cable and its power, then start "
                      "again");
    const int64_t now = running_time(element);
    const GstClockTime start = gst_element_get_start_time(element);
    const int64_t since = GST_CLOCK_TIME_IS_VALID(start) ? static_cast<int64_t>(start) : 0;
    // Frames that came while nothing was playing are stale.
    const auto frame = stream->take([&](int64_t age) { return now >= 0 && now - age < since; });
    report_incomplete(element, lock);
    if (frame) {
      *buffer = finish(element, *frame, now);
      return GST_FLOW_OK;
    }
    if (flushing_ || lost_) continue;
    if (timeout == 0) {
      changed.wait(lock);
      continue;
    }
    // Slow cameras have the time of three frames.
    const double rate = layout.frame_rate;
    const auto limit = std::chrono::duration_cast<Time::duration>(
        std::chrono::duration<double>(std::max(timeout * 1e-3, rate > 0 ? 3 / rate : 0)));
    if (Time::now() < quiet_since + limit) {
      changed.wait_until(lock, quiet_since + limit);
      continue;
    }
    ++timeouts_;
    if (settings.trigger_source.empty()) {
      const double seconds = std::chrono::duration<double>(Time::now() - began).count();
      throw Error(ErrorKind::connection,
                  "no frame came from the camera " + name + " in " + std::to_string(seconds) +
                      " seconds: is it connected, and does it run without a trigger? (timeout "
                      "sets the time, trigger-source says that it is triggered)");
    }
    // A missing trigger is no error; a missing camera is.
    quiet_since = Time::now();
    const auto asked = camera;
    lock.unlock();
    const bool there = asked->answers();
    lock.lock();
    lost_ = lost_ || !there;
  }
}

}  // namespace inverse
