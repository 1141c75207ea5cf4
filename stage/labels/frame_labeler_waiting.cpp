// Frames of a FrameLabeler that wait for a picture that confirms their labels. Where the lights are
// stopped or started again among single lights, nothing tells before that.
#include <algorithm>
#include <utility>

#include "frame_labeler.hpp"

namespace inverse {
namespace {

using Position = LightProgram::Position;

bool has_checks(const LightProgram& program) {
  return program.marker != LightProgram::Marker::none &&
         std::ranges::any_of(program.steps,
                             [](const LightStep& step) { return is_check(step.kind); });
}

constexpr int64_t kBeside = 2;  // triggers that a frame may be stamped late by

/// The longest run of steps whose pictures confirm nothing; around the end, too.
uint32_t longest_run(const LightProgram& program) {
  uint32_t longest = 0, run = 0;
  for (size_t i = 0; i < 2 * program.steps.size(); ++i) {
    run = is_check(program.steps[i % program.steps.size()].kind) ? 0 : run + 1;
    longest = std::max(longest, run);
  }
  return longest;
}

bool has_weak(const LightProgram& program) {
  return std::ranges::any_of(program.steps, [](const LightStep& step) {
    return step.kind == StepKind::olat || step.kind == StepKind::custom;
  });
}

}  // namespace

uint32_t FrameLabeler::longest_wait(const LightProgram& program, const Params& params) {
  if (!has_weak(program)) return 0;
  if (!has_checks(program)) return params.id_bits ? 0 : 1;
  return std::min(2 * longest_run(program) + 1, params.hold);
}

bool FrameLabeler::all_confirmed(const LightProgram& program, const Params& params) {
  const bool lights = std::ranges::any_of(
      program.steps, [](const LightStep& step) { return step.kind == StepKind::olat; });
  return !lights || (has_checks(program) && longest_run(program) <= params.hold);
}

/// Whether frames will come whose pictures tell.
bool FrameLabeler::confirmable() const { return evidence_.started() && has_checks(program_); }

void FrameLabeler::mark_told(uint64_t token, bool told) {
  const auto at = std::find_if(seen_.rbegin(), seen_.rend(),
                               [&](const Seen& seen) { return seen.token == token; });
  if (at != seen_.rend()) at->told = told;
}

void FrameLabeler::wait(const Unconfirmed& one, std::vector<Labeled>& out) {
  unsettled_.frames.push_back(one);
  mark_told(one.frame.token, false);
  const size_t most = (unsettled_.suspected ? 2 : 1) * size_t{params_.hold};
  if (unsettled_.frames.size() > most) release(1, out);
}

/// Tells the oldest of those that wait.
void FrameLabeler::release(size_t count, std::vector<Labeled>& out) {
  for (size_t i = 0; i < count; ++i) {
    mark_told(unsettled_.frames.front().frame.token, true);
    out.push_back(unsettled_.frames.front().frame);
    unsettled_.frames.pop_front();
  }
  unsettled_.confirmed -= std::min(unsettled_.confirmed, count);
}

void FrameLabeler::release_confirmed(std::vector<Labeled>& out) {
  release(unsettled_.confirmed, out);
}

/// Nothing has been said of those that wait, and they are looked at again.
void FrameLabeler::revoke() {
  if (unsettled_.frames.empty()) return;
  for (const Unconfirmed& one : unsettled_.frames) --count_of(one.frame.fate);
  counts_.missing = unsettled_.frames.front().missing;
  unsettled_ = {};
}

/// Whether the program has a picture to confirm a step that is still to come.
bool FrameLabeler::check_follows(Position position) const {
  if (position.pass + 1 < program_.repeat || program_.repeat == 0) return true;
  if (position.part == Position::Part::marker) return true;
  return std::any_of(program_.steps.begin() + position.index, program_.steps.end(),
                     [](const LightStep& step) { return is_check(step.kind); });
}

/// No more pictures come that could confirm: those that should have been are not labeled.
void FrameLabeler::end_of_evidence(std::vector<Labeled>& out) {
  unsettled_.suspected.reset();
  unsettled_.doubted = false;
  release_confirmed(out);
  if (confirmable())
    for (Unconfirmed& one : unsettled_.frames) {
      if (one.frame.fate != Fate::labeled || !check_follows(one.frame.position)) continue;
      --counts_.labeled;
      ++counts_.ambiguous;
      one.frame = {one.frame.token, Fate::ambiguous, 0, {}};
    }
  release(unsettled_.frames.size(), out);
}

/// Whether a bright frame at a trigger may be a tracking frame that is stamped late: one of those
/// beside it is not where it should be.
bool FrameLabeler::late_tracking_frame(int64_t trigger) const {
  for (int64_t beside = trigger - kBeside; beside <= trigger + kBeside; ++beside) {
    if (beside == trigger || beside < *anchor_ || seen_at(beside)) continue;
    if (program_.kind(program_.at(static_cast<uint64_t>(beside - *anchor_))) == StepKind::tracking)
      return true;
  }
  return false;
}

/// A frame that was too bright: the program may have been started again. Its phase may be such that
/// tracking frames come as before, so that until this is known none is confirmed by them.
void FrameLabeler::look_at_suspicion(std::vector<Labeled>& out) {
  if (!unsettled_.suspected || !anchor_) return;
  Anchor anchor;
  const Match match = matches(*unsettled_.suspected, anchor);
  if (match == Match::yes && !late_tracking_frame(*unsettled_.suspected + 1)) {
    ++counts_.resynchronizations;
    revoke();
    lose_anchor();
    return take_anchor(anchor, out);
  }
  if (match == Match::wait && seen_.back().trigger - *unsettled_.suspected < longest_search())
    return;
  unsettled_.suspected.reset();
  release_confirmed(out);
}

}  // namespace inverse
