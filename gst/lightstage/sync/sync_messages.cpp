// SPDX-License-Identifier: LGPL-2.1-or-later
// Messages and stats of lightstagesync: cameras that stop, frames that are lost.
#include <algorithm>

#include "sync_element.hpp"

namespace inverse {
namespace {

constexpr auto kStalled = std::chrono::seconds(2);    // without a frame
constexpr auto kNotBegun = std::chrono::seconds(30);  // the same, while a source makes itself ready
constexpr uint32_t kFewPeriods = 4;                   // the same, in slow programs
constexpr auto kBetweenWarnings = std::chrono::seconds(1);

double seconds(SyncCamera::Clock::duration time) {
  return std::chrono::duration<double>(time).count();
}

const char* reason_of(FrameLabeler::Fate fate) {
  using Fate = FrameLabeler::Fate;
  switch (fate) {
    case Fate::labeled:
      return "labeled";
    case Fate::duplicate:
      return "second frame of its trigger";
    case Fate::late:
      return "after a frame of a later trigger, or stamped too late";
    case Fate::ambiguous:
      return "several triggers fit";
    case Fate::contradicted:
      return "time stamp and picture fit different steps";
    case Fate::before_marker:
      return "before the marker of the program, or after labels were lost";
    case Fate::ended:
      return "after the end of the program";
    case Fate::untimed:
      return "it has neither a time nor a frame id";
  }
  return "";
}

const char* name_of(LightProgram::Position::Part part) {
  using Part = LightProgram::Position::Part;
  return part == Part::marker ? "marker" : part == Part::step ? "step" : "end";
}

}  // namespace

void SyncElement::log_label(const SyncCamera& camera, const SyncCamera::Item& item,
                            const FrameLabeler::Labeled& frame, bool passes) const {
  const GstClockTime time = GST_BUFFER_PTS(GST_BUFFER_CAST(item.object));
  if (frame.fate == FrameLabeler::Fate::labeled)
    GST_CAT_DEBUG_OBJECT(log_.category, camera.sink,
                         "frame at %" GST_TIME_FORMAT " is labeled: trigger %" G_GUINT64_FORMAT
                         ", %s %u of pass %" G_GUINT64_FORMAT,
                         GST_TIME_ARGS(time), frame.trigger, name_of(frame.position.part),
                         frame.position.index, frame.position.pass);
  else
    GST_CAT_DEBUG_OBJECT(log_.category, camera.sink,
                         "frame at %" GST_TIME_FORMAT " has no label and is %s: %s",
                         GST_TIME_ARGS(time), passes ? "passed" : "dropped", reason_of(frame.fate));
}

void SyncElement::warn(const std::string& text) { warnings_.push_back(text); }

void SyncElement::report_event(const char* event, const SyncCamera& camera, GstStructure* more) {
  GstStructure* fields = gst_structure_new("lightstagesync", "event", G_TYPE_STRING, event,
                                           "camera", G_TYPE_STRING, camera.name().c_str(), nullptr);
  if (more) {
    for (gint i = 0; i < gst_structure_n_fields(more); ++i) {
      const char* field = gst_structure_nth_field_name(more, static_cast<guint>(i));
      gst_structure_set_value(fields, field, gst_structure_get_value(more, field));
    }
    gst_structure_free(more);
  }
  messages_.push_back(gst_message_new_element(GST_OBJECT(element_), fields));
}

/// Posts pending messages. The mutex is not locked meanwhile: a handler may read stats.
void SyncElement::post(Lock& lock) {
  if (messages_.empty() && warnings_.empty()) return;
  std::vector<GstMessage*> messages;
  std::vector<std::string> warnings;
  messages.swap(messages_);
  warnings.swap(warnings_);
  lock.unlock();
  for (GstMessage* message : messages) {
    GST_CAT_INFO_OBJECT(log_.category, element_, "%" GST_PTR_FORMAT,
                        gst_message_get_structure(message));
    gst_element_post_message(element_, message);
  }
  for (const std::string& text : warnings)
    post_warning(log_of(GST_ELEMENT(element_)), GST_STREAM_ERROR, GST_STREAM_ERROR_FAILED, "%s",
                 text.c_str());
  lock.lock();
}

SyncElement::Clock::duration SyncElement::longest_silence(const SyncCamera& camera) const {
  const auto timeout = std::chrono::duration<double>(frame_timeout());
  return std::max<Clock::duration>({camera.begun ? kStalled : kNotBegun,
                                    std::chrono::duration_cast<Clock::duration>(timeout),
                                    periods(kFewPeriods)});
}

/// Whether the frames of a camera can come late, because its source waits. A camera that has not
/// begun may be live; the others decide.
bool SyncElement::can_wait(const SyncCamera& camera) const {
  if (camera.stalled) return false;
  if (camera.begun) return !camera.live;
  return std::ranges::none_of(cameras_, [](const auto& other) { return other.second->live; });
}

/// Reports cameras that have stopped, and does not wait for them any longer.
void SyncElement::report_stalled_cameras() {
  const auto now = Clock::now();
  const auto timeout = std::chrono::duration<double>(frame_timeout());
  if (!playing_) {
    lacking_since_ = now;
    return;
  }
  for (auto& [number, camera] : cameras_) {
    if (camera->stalled || camera->ended || camera->blocked || camera->flushing ||
        camera->in_sets >= max_in_sets(*camera) ||
        now - camera->last_arrival < longest_silence(*camera))
      continue;
    camera->stalled = true;
    report_event("camera-stopped", *camera);
    const auto silence = std::to_string(static_cast<int>(seconds(now - camera->last_arrival)));
    if (camera->begun)
      warn("camera " + camera->name() + " has sent no frame for " + silence +
           " s; check the camera, its cable and its trigger");
    else
      warn(
          "camera " + camera->name() + " has not begun to send within " + silence +
          " s: its source has not even agreed on a format; check whether that is started and finds "
          "its camera");
  }
  const auto lacking = sets_.lacking();
  const bool held_up = std::any_of(lacking.begin(), lacking.end(), [&](uint32_t number) {
    const SyncCamera& camera = *cameras_.at(number);
    return camera.blocked || can_wait(camera);  // by downstream
  });
  if (lacking.empty() || held_up || lacking != lacking_) {
    lacking_ = lacking;
    lacking_since_ = now;
    return;
  }
  // Frames that are here may wait for the one that confirms their labels.
  const bool unsure = std::ranges::any_of(
      lacking, [&](uint32_t number) { return cameras_.at(number)->waits_for_labels(); });
  if (now - lacking_since_ < timeout + (unsure ? periods(kLongestWait) : Clock::duration{})) return;
  for (const uint32_t number : lacking) leave_alone(*cameras_.at(number));
  lacking_.clear();
  advance();
}

/// Sets do not wait for a camera any more.
void SyncElement::leave_alone(SyncCamera& camera) {
  camera.left_alone = true;
  sets_.wait_for(camera.number, false);
  const bool elsewhere = camera.run != 0 && camera.run != newest_run();
  report_event("camera-excluded", camera,
               gst_structure_new("more", "another-start", G_TYPE_BOOLEAN, elsewhere, nullptr));
  if (elsewhere) {
    const bool pass = labels_->program().marker == LightProgram::Marker::pass;
    warn("the frames of camera " + camera.name() +
         " are counted from another start of the light program than those of the newest one, so "
         "that they meet in no set" +
         (pass ? ": by its time stamps it is not certain which passes are the same"
               : std::string()) +
         "; start the program of the lights once all cameras send" +
         (pass ? ", or see to it that their time stamps are of one clock"
               : std::string(", or give it the marker \"pass\"")));
    return;
  }
  warn("the frames of other cameras have waited " + std::to_string(frame_timeout()) + " s for " +
       camera.name() + (camera.begun ? "; " : ", whose source has not begun; ") +
       (params_.sets == SyncParams::Sets::complete
            ? "they are dropped until it sends labeled frames again (sets=all lets them pass)"
            : "they go on without it until it sends labeled frames again"));
}

/// A frame was dropped because another camera has none: reported once if that camera has ended.
/// Streams that end together do so within some frames.
void SyncElement::lacked_ended(uint32_t number) {
  const auto has_ended = [](const auto& camera) { return camera.second->ended; };
  const auto ended = std::ranges::find_if(cameras_, has_ended);
  const auto going_on = std::ranges::find_if_not(cameras_, has_ended);
  // One camera counts for all.
  if (ended == cameras_.end() || going_on == cameras_.end() || going_on->first != number) return;
  if (++lacked_ended_ != kLongestWait) return;
  warn(
      "camera " + ended->second->name() +
      " has ended: the frames of the others are in no complete set, and are dropped (sets=all lets "
      "them pass)");
}

/// Reports events of a camera's frames; losses at most once a second.
void SyncElement::report(SyncCamera& camera) {
  if (camera.stalled) {
    camera.stalled = false;
    report_event("camera-sends", camera);
  }
  if (trigger_) return;  // the trigger reports
  const FrameLabeler& labeler = *camera.labeler;
  const FrameLabeler::Counts& counts = labeler.counts();
  if (labeler.anchored() != camera.was_anchored) {
    camera.was_anchored = labeler.anchored();
    report_event(camera.was_anchored ? "marker" : "unsynchronized", camera);
  }
  if ((!lights_ || lights_->started()) && camera.labeler->take_overdue())
    warn("camera " + camera.name() +
         " has not seen the marker of the light program (black, full on, "
         "black) for " +
         std::to_string(params_.marker_timeout) +
         " s; start the program of the lights, or check whether the camera sees them and has the "
         "program's rate");
  const auto now = Clock::now();
  if (now - camera.reported_at < kBetweenWarnings) return;
  const FrameLabeler::Counts& before = camera.reported;
  std::string text;
  GstStructure* more = gst_structure_new_empty("more");
  const auto add = [&](uint64_t count, uint64_t reported, const char* field, const char* what) {
    if (count <= reported) return;
    text += (text.empty() ? "" : ", ") + std::to_string(count - reported) + " " + what;
    gst_structure_set(more, field, G_TYPE_UINT64, count - reported, nullptr);
  };
  add(counts.missing, before.missing, "missing", "lost");
  add(counts.duplicates, before.duplicates, "duplicates", "doubled");
  add(counts.late, before.late, "late", "late");
  add(counts.ambiguous, before.ambiguous, "ambiguous", "of no certain trigger");
  add(counts.contradicted, before.contradicted, "contradicted",
      "that show lights that do not match their timestamp");
  add(counts.untimed, before.untimed, "untimed", "without a time stamp");
  add(counts.resynchronizations, before.resynchronizations, "resynchronizations",
      labels_->program().marker == LightProgram::Marker::none
          ? "times the count was lost; the program has no marker, so that there are no more "
            "labels: "
            "start the lights and this element anew, or give the program the marker \"pass\""
          : "times the count was lost; labels go on with the next marker");
  if (text.empty()) {
    gst_structure_free(more);
    return;
  }
  camera.reported = counts;
  camera.reported_at = now;
  report_event("frames", camera, more);
  warn("frames of camera " + camera.name() + ": " + text);
}

GstStructure* SyncElement::camera_stats(const SyncCamera& camera) const {
  const FrameLabeler::Counts counts = counts_of(camera);
  const auto rate = camera.labeler ? camera.labeler->rate() : std::pair{0.0, 0.0};
  GstStructure* stats = gst_structure_new(
      camera.name().c_str(), "frames", G_TYPE_UINT64, counts.frames, "labeled", G_TYPE_UINT64,
      counts.labeled, "sent", G_TYPE_UINT64, camera.sent, "missing", G_TYPE_UINT64, counts.missing,
      "duplicates", G_TYPE_UINT64, counts.duplicates, "late", G_TYPE_UINT64, counts.late,
      "ambiguous", G_TYPE_UINT64, counts.ambiguous, "contradicted", G_TYPE_UINT64,
      counts.contradicted, "untimed", G_TYPE_UINT64, counts.untimed, "before-marker", G_TYPE_UINT64,
      counts.before_marker, "after-end", G_TYPE_UINT64, counts.ended, "incomplete", G_TYPE_UINT64,
      camera.incomplete, "markers", G_TYPE_UINT64, counts.markers, "resynchronizations",
      G_TYPE_UINT64, counts.resynchronizations, "synchronized", G_TYPE_BOOLEAN,
      trigger_ ? counts.labeled > 0 : camera.labeler && camera.labeler->anchored(), "rate-low",
      G_TYPE_DOUBLE, rate.first, "rate-high", G_TYPE_DOUBLE, rate.second, nullptr);
  if (camera.assembler) camera.assembler->add_stats(stats);
  return stats;
}

GstStructure* SyncElement::stats() const {
  std::lock_guard lock(mutex_);
  GstStructure* stats = gst_structure_new("inverse-stats", "cameras", G_TYPE_UINT,
                                          static_cast<guint>(cameras_.size()), "sets-complete",
                                          G_TYPE_UINT64, sets_.complete_sets(), "sets-incomplete",
                                          G_TYPE_UINT64, sets_.incomplete_sets(), nullptr);
  if (trigger_) trigger_->add_stats(stats);
  for (const auto& [number, camera] : cameras_) {
    GstStructure* one = camera_stats(*camera);
    for (gint i = 0; i < gst_structure_n_fields(one); ++i) {
      // Counts of all cameras together.
      const char* field = gst_structure_nth_field_name(one, static_cast<guint>(i));
      guint64 count = 0, sum = 0;
      if (!gst_structure_get_uint64(one, field, &count)) continue;
      gst_structure_get_uint64(stats, field, &sum);
      gst_structure_set(stats, field, G_TYPE_UINT64, sum + count, nullptr);
    }
    gst_structure_set(stats, camera->name().c_str(), GST_TYPE_STRUCTURE, one, nullptr);
    gst_structure_free(one);
  }
  return stats;
}

}  // namespace inverse
