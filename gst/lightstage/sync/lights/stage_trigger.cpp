// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stage_trigger.hpp"

#include <algorithm>

#include "gst/base/log/errors.hpp"
#include "gst/base/log/log.hpp"
#include "light_upload.hpp"

namespace inverse {

StageTrigger::StageTrigger(GstElement* element, std::shared_ptr<const StageLabels> labels,
                           const Settings& settings, const std::map<uint32_t, GstPad*>& sinks)
    : element_(element), labels_(std::move(labels)), settings_(settings) {
  if (settings_.lights.backend == LightDriverSettings::Backend::serial &&
      !settings_.lights.serial.pulses)
    throw Error(ErrorKind::unsupported,
                "camera-trigger=aravis-software steps the lights itself: leave pulses=true");
  if (sinks.empty())
    throw Error(ErrorKind::unsupported,
                "camera-trigger: request a sink pad for each camera before the start");
  for (const auto& [number, sink] : sinks) {
    Camera camera;
    camera.number = number;
    camera.trigger = CameraTrigger::find(sink);
    camera.trigger->prepare();
    cameras_.push_back(std::move(camera));
  }
  lights_ = make_light_driver(settings_.lights);
  uploader_ = std::thread([this] { upload(); });
}

StageTrigger::~StageTrigger() {
  {
    const Lock lock(mutex_);
    ending_ = true;
    if (!uploaded_) lights_->cancel();
  }
  uploader_.join();
  if (capture_) capture_->stop();
  try {
    lights_->black();
  } catch (const std::exception& error) {
    GST_CAT_WARNING_OBJECT(log_of(GST_ELEMENT(element_)).category, element_, "lights: %s",
                           error.what());  // the loss itself was an error before
  }
}

/// May take minutes on a serial line, so no state change waits for it.
void StageTrigger::upload() {
  const bool good = upload_program(element_, *lights_, labels_->program(), [this] {
    const Lock lock(mutex_);
    return ending_;
  });
  if (!good) return;
  guarded(element_, [this] {
    const Lock lock(mutex_);
    uploaded_ = true;
    if (!ending_) begin();
  });
}

void StageTrigger::report_lost(uint64_t trigger, const std::vector<size_t>& cameras) const {
  std::string names;
  for (const size_t i : cameras) names += (names.empty() ? "" : ", ") + cameras_[i].trigger->name();
  post_warning(log_of(element_), GST_STREAM_ERROR, GST_STREAM_ERROR_FAILED,
               "no frame of trigger %" G_GUINT64_FORMAT " came from %s", trigger, names.c_str());
}

TriggeredCapture::Listener StageTrigger::listener() {
  TriggeredCapture::Listener listener;
  listener.lost = [this](uint64_t trigger, const std::vector<size_t>& cameras) {
    report_lost(trigger, cameras);
  };
  listener.ended = [this] {
    for (const Camera& camera : cameras_) camera.trigger->end();
  };
  listener.failed = [this](const Error& error) { post_error(element_, error); };
  return listener;
}

void StageTrigger::camera_ready(uint32_t number) {
  const Lock lock(mutex_);
  for (Camera& camera : cameras_) {
    if (camera.number != number) continue;
    camera.trigger->configure();
    camera.ready = true;
    begin();
    return;
  }
  throw Error(ErrorKind::unsupported,
              "camera-trigger: request a sink pad for each camera before the start");
}

void StageTrigger::set_playing(bool playing) {
  Lock lock(mutex_);
  if (playing == playing_) return;
  playing_ = playing;
  if (playing) return begin();
  const auto capture = capture_;
  lock.unlock();  // a frame may be arriving
  const uint64_t next = capture ? capture->stop() : 0;
  lock.lock();
  next_ = next;
}

/// With the mutex locked.
void StageTrigger::begin() {
  if (!playing_ || !uploaded_ ||
      !std::all_of(cameras_.begin(), cameras_.end(), [](const Camera& one) { return one.ready; }))
    return;
  if (capture_ && capture_->running()) return;  // caps have changed
  if (!capture_) {
    std::vector<TriggeredCamera*> cameras;
    for (const Camera& camera : cameras_) cameras.push_back(camera.trigger.get());
    capture_ = std::make_shared<TriggeredCapture>(labels_->program(), *lights_, cameras,
                                                  settings_.capture, listener());
  }
  capture_->start(next_);
}

/// Time since a frame began to arrive, in seconds, if its source reports it.
std::optional<double> StageTrigger::age(const CameraTrigger& camera, GstBuffer* buffer) const {
  if (!camera.has_times() || !GST_BUFFER_PTS_IS_VALID(buffer)) return std::nullopt;
  GstClock* clock = gst_element_get_clock(element_);
  if (!clock) return std::nullopt;
  const auto now = static_cast<int64_t>(gst_clock_get_time(clock)) -
                   static_cast<int64_t>(gst_element_get_base_time(element_));
  gst_object_unref(clock);
  return static_cast<double>(now - static_cast<int64_t>(GST_BUFFER_PTS(buffer))) * 1e-9;
}

StageTrigger::Handling::Handling(StageTrigger& trigger, uint32_t number, GstBuffer* buffer) {
  CameraTrigger* camera = nullptr;
  {
    const Lock lock(trigger.mutex_);
    for (size_t i = 0; i < trigger.cameras_.size(); ++i) {
      if (trigger.cameras_[i].number != number) continue;
      camera = trigger.cameras_[i].trigger.get();
      index_ = i;
    }
    if (camera) capture_ = trigger.capture_;
  }
  if (!capture_) return;  // nothing was triggered yet
  std::optional<uint64_t> id;
  if (camera->frame_id_bits() && GST_BUFFER_OFFSET_IS_VALID(buffer)) id = GST_BUFFER_OFFSET(buffer);
  label_ = capture_->frame(index_, id, trigger.age(*camera, buffer));
}

StageTrigger::Handling::~Handling() {
  if (capture_) capture_->done(index_);
}

void StageTrigger::add_stats(GstStructure* stats) const {
  TriggeredCapture::Stats counts;
  {
    const Lock lock(mutex_);
    if (capture_) counts = capture_->stats();
  }
  gst_structure_set(stats, "triggers", G_TYPE_UINT64, counts.triggers, "triggers-fired",
                    G_TYPE_UINT64, counts.fired, "triggers-retried", G_TYPE_UINT64, counts.retried,
                    "triggers-dropped", G_TYPE_UINT64, counts.dropped, "frames-unasked",
                    G_TYPE_UINT64, counts.surplus + counts.early, "frames-doubtful", G_TYPE_UINT64,
                    counts.ambiguous + counts.late, nullptr);
}

}  // namespace inverse
