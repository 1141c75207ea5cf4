// Frames of a FrameLabeler that wait for a picture that confirms their labels. Where the lights are
// stopped or started again among single lights, nothing tells before that.
#include <algorithm>
#include <utility>

#include "frame_labeler.hpp"

namespace inverse {
namespace {

using Position = LightProgram::Position;

bool is_check(StepKind kind) {
  return kind == StepKind::tracking || kind == StepKind::gradient_a || kind == StepKind::gradient_b;
}

bool has_checks(const LightProgram& program) {
  return program.marker != LightProgram::Marker::none &&
         std::ranges::any_of(program.steps,
                             [](const LightStep& step) { return is_check(step.kind); });
}

constexpr int64_t kBeside = 2;  // triggers that a frame may be stamped late by

}  // namespace

uint32_t FrameLabeler::longest_wait(const LightProgram& program, const Params& params) {
  const auto weak = [](const LightStep& step) {
    return step.kind == StepKind::olat || step.kind == StepKind::custom;
  };
  if (std::ranges::none_of(program.steps, weak)) return 0;
  if (!has_checks(program)) return params.id_bits ? 0 : 1;
  uint32_t longest = 0, run = 0;
  // Around the end, too.
  for (size_t i = 0; i < 2 * program.steps.size(); ++i) {
    run = is_check(program.steps[i % program.steps.size()].kind) ? 0 : run + 1;
    longest = std::max(longest, run);
  }
  return std::min(longest, params.hold);
}

/// Whether frames will come whose pictures tell.
bool FrameLabeler::confirmable() const { return evidence_.started() && has_checks(program_); }

void FrameLabeler::mark_told(uint64_t token, bool told) {
  const auto at = std::find_if(seen_.rbegin(), seen_.rend(),
                               [&](const Seen& seen) { return seen.token == token; });
  if (at != seen_.rend()) at->told = told;
}

void FrameLabeler::wait(const Unconfirmed& one, std::vector<Labeled>& out) {
  unconfirmed_.push_back(one);
  mark_told(one.frame.token, false);
  if (unconfirmed_.size() > params_.hold) release(1, out);
}

/// Tells the oldest of those that wait.
void FrameLabeler::release(size_t count, std::vector<Labeled>& out) {
  for (size_t i = 0; i < count; ++i) {
    mark_told(unconfirmed_.front().frame.token, true);
    out.push_back(unconfirmed_.front().frame);
    unconfirmed_.pop_front();
  }
  confirmed_ -= std::min(confirmed_, count);
}

void FrameLabeler::release_confirmed(std::vector<Labeled>& out) { release(confirmed_, out); }

/// Nothing has been said of those that wait, and they are looked at again.
void FrameLabeler::revoke() {
  if (unconfirmed_.empty()) return;
  for (const Unconfirmed& one : unconfirmed_) --count_of(one.frame.fate);
  counts_.missing = unconfirmed_.front().missing;
  unconfirmed_.clear();
  confirmed_ = 0;
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
  if (!suspected_ || !anchor_) return;
  Anchor anchor;
  const Match match = matches(*suspected_, anchor);
  if (match == Match::yes && !late_tracking_frame(*suspected_ + 1)) {
    ++counts_.resynchronizations;
    revoke();
    lose_anchor();
    return take_anchor(anchor, out);
  }
  if (match == Match::wait && seen_.back().trigger - *suspected_ < int64_t{params_.hold}) return;
  suspected_.reset();
  release_confirmed(out);
}

}  // namespace inverse
