// SPDX-License-Identifier: LGPL-2.1-or-later
// FrameLabeler: frames that wait for a check frame. If the lights stop or restart among single
// lights, no earlier image shows it.
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

constexpr int64_t kMaxLate = 2;  // triggers by which a frame may be stamped late

/// The longest cyclic run of steps without a check frame.
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

/// Whether check frames will come.
bool FrameLabeler::confirmable() const { return evidence_.started() && has_checks(program_); }

void FrameLabeler::mark_reported(uint64_t token, bool reported) {
  const auto at = std::find_if(seen_.rbegin(), seen_.rend(),
                               [&](const Seen& seen) { return seen.token == token; });
  if (at != seen_.rend()) at->reported = reported;
}

void FrameLabeler::wait(const Unconfirmed& one, std::vector<Labeled>& out) {
  pending_.frames.push_back(one);
  mark_reported(one.frame.token, false);
  const size_t max = (pending_.suspected ? 2 : 1) * size_t{params_.hold};
  if (pending_.frames.size() > max) release(1, out);
}

/// Reports the oldest waiting frames.
void FrameLabeler::release(size_t count, std::vector<Labeled>& out) {
  for (size_t i = 0; i < count; ++i) {
    mark_reported(pending_.frames.front().frame.token, true);
    out.push_back(pending_.frames.front().frame);
    pending_.frames.pop_front();
  }
  pending_.confirmed -= std::min(pending_.confirmed, count);
}

void FrameLabeler::release_confirmed(std::vector<Labeled>& out) {
  release(pending_.confirmed, out);
}

/// Undoes the labels of waiting frames, which have not been reported.
void FrameLabeler::revoke() {
  if (pending_.frames.empty()) return;
  for (const Unconfirmed& one : pending_.frames) --count_of(one.frame.fate);
  counts_.missing = pending_.frames.front().missing;
  pending_ = {};
}

/// Whether the program has a check frame after this position.
bool FrameLabeler::check_follows(Position position) const {
  if (position.pass + 1 < program_.repeat || program_.repeat == 0) return true;
  if (position.part == Position::Part::marker) return true;
  return std::any_of(program_.steps.begin() + position.index, program_.steps.end(),
                     [](const LightStep& step) { return is_check(step.kind); });
}

/// No more check frames come: frames that need one become ambiguous.
void FrameLabeler::end_of_evidence(std::vector<Labeled>& out) {
  pending_.suspected.reset();
  pending_.uncertain = false;
  release_confirmed(out);
  if (confirmable())
    for (Unconfirmed& one : pending_.frames) {
      if (one.frame.fate != Fate::labeled || !check_follows(one.frame.position)) continue;
      --counts_.labeled;
      ++counts_.ambiguous;
      one.frame = {one.frame.token, Fate::ambiguous, 0, {}};
    }
  release(pending_.frames.size(), out);
}

/// Whether a bright frame at a trigger may be a tracking frame with a late time stamp: a nearby
/// tracking frame is missing.
bool FrameLabeler::late_tracking_frame(int64_t trigger) const {
  for (int64_t beside = trigger - kMaxLate; beside <= trigger + kMaxLate; ++beside) {
    if (beside == trigger || beside < *anchor_ || seen_at(beside)) continue;
    if (program_.kind(program_.at(static_cast<uint64_t>(beside - *anchor_))) == StepKind::tracking)
      return true;
  }
  return false;
}

/// Checks whether a frame that was too bright belongs to a restarted program. Tracking frames of
/// the restart may coincide with expected ones, so they confirm nothing until this is decided.
void FrameLabeler::check_suspicion(std::vector<Labeled>& out) {
  if (!pending_.suspected || !anchor_) return;
  Anchor anchor;
  const Match match = matches(*pending_.suspected, anchor);
  if (match == Match::yes && !late_tracking_frame(*pending_.suspected + 1)) {
    ++counts_.resynchronizations;
    revoke();
    lose_anchor();
    return take_anchor(anchor, out);
  }
  if (match == Match::wait && seen_.back().trigger - *pending_.suspected < longest_search()) return;
  pending_.suspected.reset();
  release_confirmed(out);
}

}  // namespace inverse
