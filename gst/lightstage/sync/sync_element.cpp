// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sync_element.hpp"

#include <algorithm>

#include "gst/base/log/errors.hpp"
#include "gst/base/log/log.hpp"
#include "gst/lightstage/sync/assemble/olat_assembler.hpp"
#include "gst/lightstage/sync/assemble/pair_assembler.hpp"
#include "gst/lightstage/sync/shared/upstream.hpp"

namespace inverse {
namespace {

constexpr uint32_t kUsualIdBits = 64;

}  // namespace

SyncElement::~SyncElement() {
  for (GstMessage* message : messages_) gst_message_unref(message);
}

bool SyncElement::start() {
  if (!check_parameters(log_, parameters_)) return false;
  SyncParams params = parameters_.snapshot();
  return guarded(element_, [&] {
    if (params.assemble != SyncParams::Assemble::olat && !params.location.empty())
      throw Error(ErrorKind::unsupported, "location is for assemble=olat: nothing else is written");
    auto labels = std::make_shared<const StageLabels>(light_program(params.program, params.rate));
    GST_CAT_INFO_OBJECT(log_.category, element_, "light program \"%s\": %s", params.program.c_str(),
                        labels->program().name.c_str());
    PairAssembler::check(params, labels->program());
    OlatAssembler::check(params, labels->program());
    auto trigger = make_trigger(params, labels);
    lights_.reset();
    if (!trigger && params.lights.backend != LightDriverSettings::Backend::none)
      lights_ = std::make_unique<LightClock>(element_, labels, params.lights, params.lead_in);
    Lock lock(mutex_);
    trigger_ = std::move(trigger);
    params_ = params;
    labels_ = std::move(labels);
    max_steps_ = max_steps();
    if (params_.camera_trigger == SyncParams::CameraTrigger::none &&
        !FrameLabeler::all_confirmed(labels_->program(), labeler_params()))
      warn("single lights of \"" + labels_->program().name +
           "\" have no tracking frame (full on) after every " +
           std::to_string(labeler_params().hold) +
           " of them at most: that the lights are in step with the count is not confirmed by "
           "pictures there");
    sets_ = FrameSets(params_.sets == SyncParams::Sets::complete);
    for (auto& [number, camera] : cameras_) {
      sets_.add_camera(number);
      make_labeler(*camera);
      make_assembler(*camera);
    }
  });
}

void SyncElement::stop() {
  std::shared_ptr<StageTrigger> trigger;  // freed after the lock, which its threads may take
  lights_.reset();
  Lock lock(mutex_);
  trigger = std::move(trigger_);
  for (auto& [number, camera] : cameras_) {
    camera->clear();
    camera->labeler.reset();
    camera->assembler.reset();
    camera->info.reset();
    camera->linear.reset();
    camera->last_trigger.reset();
    camera->stream_id.clear();
    camera->ended = camera->left_alone = camera->stalled = camera->was_anchored =
        camera->upstream_known = camera->program_ended = camera->begun = false;
    camera->id_bits = 0;
    camera->sinks_wait = 0;
    camera->flow = GST_FLOW_OK;
    camera->reported = camera->triggered = {};
    camera->run = camera->start = camera->incomplete = camera->sent = 0;
  }
  sets_ = FrameSets(true);
  labels_.reset();
  run_ = lacked_ended_ = 0;
  lock.unlock();
  context_.release();
}

void SyncElement::set_playing(bool playing) {
  std::shared_ptr<StageTrigger> trigger;
  {
    Lock lock(mutex_);
    trigger = trigger_;
    playing_ = playing;
    lacking_since_ = Clock::now();
    for (auto& [number, camera] : cameras_) {
      camera->last_arrival = lacking_since_;
      // The program starts again, which no camera has seen yet.
      if (playing && lights_ && camera->labeler) {
        labeled(*camera, camera->labeler->drain());
        camera->labeler->reset();
      }
    }
    advance();
  }
  if (trigger) trigger->set_playing(playing);
  if (lights_) playing ? lights_->play() : lights_->pause();
}

SyncElement::Clock::duration SyncElement::periods(uint32_t count) const {
  return std::chrono::duration_cast<Clock::duration>(
      std::chrono::nanoseconds(labels_ ? count * labels_->period() : 0));
}

FrameLabeler::Params SyncElement::labeler_params(uint32_t source_id_bits) const {
  const auto set = static_cast<uint32_t>(params_.frame_id_bits);
  FrameLabeler::Params params;
  params.jitter = params_.jitter;
  if (params_.frame_id != SyncParams::FrameId::none)
    params.id_bits = set ? set : source_id_bits ? source_id_bits : kUsualIdBits;
  params.marker_timeout = params_.marker_timeout;
  return params;
}

void SyncElement::make_labeler(SyncCamera& camera) {
  camera.labeler =
      std::make_unique<FrameLabeler>(labels_->program(), labeler_params(camera.id_bits));
}

/// Queries properties of a camera's source when its first frame comes.
void SyncElement::ask_upstream(SyncCamera& camera) {
  // Frames of files can wait for each other; those of cameras cannot for long.
  GstQuery* query = gst_query_new_latency();
  gboolean live = FALSE;
  if (gst_pad_peer_query(camera.sink, query))
    gst_query_parse_latency(query, &live, nullptr, nullptr);
  gst_query_unref(query);
  const uint32_t id_bits = upstream_id_bits(camera.sink);
  Lock lock(mutex_);
  camera.live = live;
  camera.upstream_known = true;
  if (!labels_ || camera.id_bits == id_bits) return;
  camera.id_bits = id_bits;
  if (camera.labeler->counts().frames == 0) make_labeler(camera);
}

void SyncElement::make_assembler(SyncCamera& camera) {
  switch (params_.assemble) {
    case SyncParams::Assemble::none:
      camera.assembler = std::make_unique<FrameAssembler>(element_, camera.src, labels_);
      break;
    case SyncParams::Assemble::pairs:
      camera.assembler =
          std::make_unique<PairAssembler>(element_, camera.src, labels_, params_, context_);
      break;
    case SyncParams::Assemble::olat:
      camera.assembler =
          std::make_unique<OlatAssembler>(element_, camera.src, labels_, params_, camera.number);
      break;
  }
}

SyncElement::CameraPtr SyncElement::add(uint32_t number, GstPad* sink, GstPad* src) {
  Lock lock(mutex_);
  auto camera = std::make_shared<SyncCamera>(number, sink, src);
  cameras_[number] = camera;
  if (labels_) {
    sets_.add_camera(number);
    make_labeler(*camera);
    make_assembler(*camera);
    camera->last_arrival = Clock::now();
  }
  return camera;
}

SyncElement::CameraPtr SyncElement::find(GstPad* pad) const {
  std::lock_guard lock(mutex_);
  for (const auto& [number, camera] : cameras_)
    if (camera->sink == pad || camera->src == pad) return camera;
  return nullptr;
}

bool SyncElement::has(uint32_t number) const {
  std::lock_guard lock(mutex_);
  return cameras_.contains(number);
}

void SyncElement::remove(const CameraPtr& camera) {
  {
    Lock lock(mutex_);
    cameras_.erase(camera->number);
    if (labels_) sets_.remove_camera(camera->number);
    camera->released = camera->flushing = true;
    advance();
    changed_.notify_all();
    post(lock);
  }
  gst_pad_set_active(camera->sink, FALSE);
  gst_pad_set_active(camera->src, FALSE);
}

/// The flow for upstream: of its own branch, unless another branch has failed for good.
GstFlowReturn SyncElement::combined_flow(const SyncCamera& camera) const {
  bool all_ended = true, all_unlinked = true;
  for (const auto& [number, other] : cameras_) {
    if (other->flow <= GST_FLOW_NOT_NEGOTIATED) return other->flow;
    all_ended &= other->flow == GST_FLOW_EOS;
    all_unlinked &= other->flow == GST_FLOW_NOT_LINKED;
  }
  if (all_ended) return GST_FLOW_EOS;
  if (all_unlinked) return GST_FLOW_NOT_LINKED;
  return camera.flow == GST_FLOW_FLUSHING ? GST_FLOW_FLUSHING : GST_FLOW_OK;
}

GstFlowReturn SyncElement::chain(const CameraPtr& camera, GstBuffer* buffer) {
  if (!camera->info) {
    gst_buffer_unref(buffer);
    return GST_FLOW_NOT_NEGOTIATED;
  }
  std::shared_ptr<StageTrigger> trigger;
  {
    Lock lock(mutex_);
    trigger = trigger_;
  }
  std::optional<StageTrigger::Handling> handling;
  if (trigger) handling.emplace(*trigger, camera->number, buffer);
  FrameLabeler::Frame frame;
  if (GST_BUFFER_PTS_IS_VALID(buffer)) frame.time = static_cast<int64_t>(GST_BUFFER_PTS(buffer));
  if (GST_BUFFER_OFFSET_IS_VALID(buffer)) frame.id = GST_BUFFER_OFFSET(buffer);
  if (!trigger && !guarded(element_, [&] {
        frame.image = image_evidence(*camera->info, *camera->linear, buffer);
      })) {
    gst_buffer_unref(buffer);
    return GST_FLOW_ERROR;
  }
  if (!camera->upstream_known) ask_upstream(*camera);
  const GstClockTime time =
      camera->segment.format == GST_FORMAT_TIME
          ? gst_segment_to_running_time(&camera->segment, GST_FORMAT_TIME, GST_BUFFER_PTS(buffer))
          : GST_CLOCK_TIME_NONE;
  Lock lock(mutex_);
  camera->begun = true;
  camera->last_arrival = Clock::now();
  const auto full = [&] { return camera->outgoing_buffers >= max_outgoing(*camera); };
  while (!camera->flushing && !camera->ended &&
         (camera->in_sets >= max_in_sets(*camera) || full())) {
    camera->blocked = full();
    changed_.wait_for(lock, kCheckEvery);
    report_stalled_cameras();
    post(lock);
  }
  camera->blocked = false;
  camera->last_arrival = Clock::now();
  if (camera->flushing || camera->ended) {
    gst_buffer_unref(buffer);
    return camera->flushing ? GST_FLOW_FLUSHING : GST_FLOW_EOS;
  }
  frame.token = next_token_++;
  camera->line.push_back({SyncCamera::Item::State::waiting, GST_MINI_OBJECT_CAST(buffer),
                          frame.token, std::nullopt, time});
  labeled(*camera, trigger ? triggered(*camera, frame.token, handling->trigger())
                           : camera->labeler->push(
                                 frame, running_for(*camera, GST_BUFFER_PTS(buffer), time)));
  report(*camera);
  advance();
  const GstFlowReturn flow = combined_flow(*camera);
  post(lock);
  return flow;
}

/// The trigger of the cameras, null without camera-trigger.
std::shared_ptr<StageTrigger> SyncElement::make_trigger(
    const SyncParams& params, std::shared_ptr<const StageLabels> labels) const {
  if (params.camera_trigger == SyncParams::CameraTrigger::none) return nullptr;
  StageTrigger::Settings settings;
  settings.lights = params.lights;
  settings.capture.timeout = params.trigger_timeout;
  settings.capture.retries = params.trigger_retries;
  std::map<uint32_t, GstPad*> sinks;
  {
    std::lock_guard lock(mutex_);
    for (const auto& [number, camera] : cameras_) sinks[number] = camera->sink;
  }
  return std::make_shared<StageTrigger>(element_, std::move(labels), settings, sinks);
}

/// Seconds for which sets wait for a camera: as long as it may be triggered again. That adds no
/// latency, since no other frame is triggered meanwhile.
double SyncElement::frame_timeout() const {
  if (!trigger_) return params_.timeout;
  return std::max(params_.timeout, params_.trigger_timeout * (params_.trigger_retries + 3));
}

/// The label of a frame that we triggered.
std::vector<FrameLabeler::Labeled> SyncElement::triggered(
    SyncCamera& camera, uint64_t token, const std::optional<uint64_t>& trigger) const {
  FrameLabeler::Labeled frame;
  frame.token = token;
  frame.fate = trigger ? FrameLabeler::Fate::labeled : FrameLabeler::Fate::ambiguous;
  ++camera.triggered.frames;
  ++(trigger ? camera.triggered.labeled : camera.triggered.ambiguous);
  if (trigger) {
    if (camera.last_trigger && *trigger > *camera.last_trigger + 1)
      camera.triggered.missing += *trigger - *camera.last_trigger - 1;
    frame.trigger = *trigger;
    frame.position = labels_->program().at(*trigger);
  }
  return {frame};
}

FrameLabeler::Counts SyncElement::counts_of(const SyncCamera& camera) const {
  if (trigger_) return camera.triggered;
  return camera.labeler ? camera.labeler->counts() : FrameLabeler::Counts{};
}

void SyncElement::labeled(SyncCamera& camera, const std::vector<FrameLabeler::Labeled>& frames) {
  using State = SyncCamera::Item::State;
  for (const FrameLabeler::Labeled& frame : frames) {
    SyncCamera::Item* item = camera.find(frame.token);
    if (!item) continue;  // flushed meanwhile
    if (frame.fate == FrameLabeler::Fate::ended) end_program(camera, true);
    const bool is_labeled = frame.fate == FrameLabeler::Fate::labeled;
    const bool passes =
        is_labeled || (!params_.drop_unlabeled && params_.assemble == SyncParams::Assemble::none);
    log_label(camera, *item, frame, passes);
    if (!is_labeled) {
      item->state = passes ? State::leaves : State::dropped;
      continue;
    }
    camera.program_ended = false;
    item->label = FrameLabel{frame.trigger, frame.position};
    join_run(camera, frame);
    camera.start = frame.start.number;
    camera.last_trigger = frame.trigger;
    camera.last_time = item->time;
    ++camera.in_sets;
    sets_.add(camera.number, camera.run << 40 | frame.trigger, frame.token);
    // Frames of an older run are in no set of the newest one.
    if (camera.left_alone && camera.run == newest_run()) {
      camera.left_alone = false;
      sets_.wait_for(camera.number, true);
      report_event("camera-back", camera);
    }
  }
}

void SyncElement::advance() {
  using State = SyncCamera::Item::State;
  for (const FrameSets::Decided& frame : sets_.decide()) {
    const auto camera = cameras_.find(frame.camera);
    if (camera == cameras_.end()) continue;
    SyncCamera::Item* item = camera->second->find(frame.token);
    if (!item) continue;
    item->state = frame.out ? State::leaves : State::dropped;
    if (!frame.out)
      GST_CAT_DEBUG_OBJECT(log_.category, camera->second->sink,
                           "frame of trigger %" G_GUINT64_FORMAT
                           " is dropped: its set lacks frames "
                           "of other cameras",
                           item->label ? item->label->trigger : 0);
    camera->second->incomplete += frame.out ? 0 : 1;
    if (!frame.out) lacked_ended(frame.camera);
    --camera->second->in_sets;
  }
  for (auto& [number, camera] : cameras_) camera->advance();
  changed_.notify_all();
}

bool SyncElement::activate_sink(const CameraPtr& camera, bool active) {
  Lock lock(mutex_);
  camera->flushing = !active;
  changed_.notify_all();
  return true;
}

}  // namespace inverse
