// SPDX-License-Identifier: LGPL-2.1-or-later
// Which cameras of lightstagesync count from the same start of the program.
#include <algorithm>

#include "sync_element.hpp"

namespace inverse {
namespace {

constexpr auto kSameRun = std::chrono::seconds(2);  // max delay between cameras for the same marker
constexpr uint32_t kMarkerPeriods = 40;             // the same, in slow programs

}  // namespace

/// A camera's labels start: a new run of the program, unless its count continues another camera's,
/// or that has just seen the same marker. Files may begin at any time and are of one run.
void SyncElement::join_run(SyncCamera& camera, const FrameLabeler::Labeled& frame) {
  const bool another = frame.start.number != camera.start;
  const bool rises = !camera.last_trigger || frame.trigger > *camera.last_trigger;
  if (camera.run != 0 && !another && rises) return;
  if (another && frame.start.run && (*frame.start.run != camera.run || rises)) {
    camera.run = *frame.start.run;
    return;
  }
  const auto now = Clock::now();
  const bool late = now - run_since_ > std::max<Clock::duration>(kSameRun, periods(kMarkerPeriods));
  if (run_ == camera.run || (another && frame.start.apart) || (camera.live && late)) {
    ++run_;
    run_since_ = now;
  }
  camera.run = run_;
}

uint64_t SyncElement::newest_run() const {
  uint64_t newest = 0;
  for (const auto& [number, camera] : cameras_)
    if (!camera->ended) newest = std::max(newest, camera->run);
  return newest;
}

/// Position of the program according to another camera; `pts` and `time` are of one frame. Cameras'
/// time stamps are of one clock; those of files are not.
std::optional<FrameLabeler::Running> SyncElement::running_for(const SyncCamera& camera,
                                                              GstClockTime pts,
                                                              GstClockTime time) const {
  if (!camera.live || !GST_CLOCK_TIME_IS_VALID(time)) return std::nullopt;
  const uint64_t run = newest_run();
  const SyncCamera* latest = nullptr;
  for (const auto& [number, other] : cameras_) {
    const bool counts = other->live && !other->ended && other->run == run && other->last_trigger &&
                        other->labeler->anchored() &&
                        other->labeler->start().number == other->start;
    if (other.get() == &camera || !counts || !GST_CLOCK_TIME_IS_VALID(other->last_time)) continue;
    if (!latest || other->last_time > latest->last_time) latest = other.get();
  }
  if (!latest) return std::nullopt;
  const int64_t since = GST_CLOCK_DIFF(time, latest->last_time);
  return FrameLabeler::Running{static_cast<int64_t>(pts) + since, *latest->last_trigger, run,
                               camera.run == run};
}

}  // namespace inverse
