#include "frame_labeler.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace inverse {
namespace {

using Position = LightProgram::Position;
using Counted = TriggerCounter::Counted;

// Contradictions against labels; more where frames wait for a picture that confirms them.
constexpr uint32_t kContradicted = 2, kNotConfirmed = 3, kAgreed = 1, kConfirmed = 3, kTooMuch = 6;
constexpr double kVisible = 0.2;  // of what a light adds on average

TriggerCounter::Params counter_params(const FrameLabeler::Params& params) {
  return {params.jitter, params.drift, params.id_bits, params.hold};
}

/// Whether two places of a program have the same light.
bool same_light(const LightProgram& program, Position a, Position b) {
  const StepKind kind = program.kind(a);
  if (kind != program.kind(b)) return false;
  if (kind == StepKind::olat) return program.steps[a.index].light == program.steps[b.index].light;
  return kind != StepKind::custom || a.index == b.index;
}

}  // namespace

FrameLabeler::FrameLabeler(const LightProgram& program, const Params& params)
    : program_(program),
      params_(params),
      period_(1e9 * program.rate_denominator / program.rate_numerator),
      counter_(counter_params(params)),
      evidence_(program),
      epoch_(counter_.epoch()) {}

std::pair<double, double> FrameLabeler::rate() const {
  const double nominal = 1e9 / period_;
  return {nominal / counter_.fastest(), nominal / counter_.slowest()};
}

void FrameLabeler::reset() {
  counter_.restart();
  lose_anchor();
  seen_.clear();
  waiting_.clear();
  confirmed_until_.reset();
  trouble_.reset();
  over_ = begun_ = false;
  lost_anchor_.reset();
  origin_.reset();
  waiting_since_.reset();
  epoch_ = counter_.epoch();
}

void FrameLabeler::flush() {
  counter_.flush();
  waiting_.clear();
  seen_.clear();
  unsettled_ = {};
  confirmed_until_.reset();
  trouble_.reset();
  last_.reset();
  dropped_since_last_ = 0;
  if (counter_.epoch() == epoch_) return;
  epoch_ = counter_.epoch();
  lose_anchor();
  lost_anchor_.reset();
}

void FrameLabeler::lose_anchor() {
  if (anchor_) lost_anchor_ = anchor_;
  anchor_.reset();
  unsettled_ = {};
  last_.reset();
  dropped_since_last_ = contradicted_lately_ = 0;
  overdue_told_ = false;
  waiting_since_ = now_;
}

/// The program is over. Who starts it again has all the time there is.
void FrameLabeler::end() {
  lose_anchor();
  lost_anchor_.reset();
  ended_ = false;
  over_ = true;
  overdue_told_ = true;
}

bool FrameLabeler::take_overdue() {
  if (program_.marker == LightProgram::Marker::none) return false;
  if (anchor_ || overdue_told_ || !waiting_since_ || !now_) return false;
  overdue_told_ = static_cast<double>(*now_ - *waiting_since_) > params_.marker_within * 1e9;
  return overdue_told_;
}

uint64_t& FrameLabeler::count_of(Fate fate) {
  uint64_t* const counts[] = {&counts_.labeled,   &counts_.duplicates,   &counts_.late,
                              &counts_.ambiguous, &counts_.contradicted, &counts_.before_marker,
                              &counts_.ended,     &counts_.untimed};
  return *counts[static_cast<size_t>(fate)];
}

void FrameLabeler::tell(uint64_t token, Fate fate, std::vector<Labeled>& out) {
  ++count_of(fate);
  out.push_back({token, fate, 0, {}});
}

/// Whether a picture cannot be what the program shows at a trigger.
bool FrameLabeler::contradicts(int64_t trigger, const ImageEvidence& image) const {
  if (!anchor_ || trigger < *anchor_) return false;
  const Position position = program_.at(static_cast<uint64_t>(trigger - *anchor_));
  if (evidence_.contradicts(position, image)) return true;
  // The very same picture again is no picture under other lights, where these would be seen.
  if (!image.content || image.content != before_.content || !last_ || *last_ < *anchor_ ||
      *last_ == trigger || !evidence_.started())
    return false;
  const double added = image.luminance() - evidence_.black();
  const double mean = (evidence_.full() - evidence_.black()) / double(program_.lights.size());
  return added > kVisible * mean &&
         !same_light(program_, position, program_.at(static_cast<uint64_t>(*last_ - *anchor_)));
}

std::vector<FrameLabeler::Labeled> FrameLabeler::push(const Frame& frame,
                                                      const std::optional<Running>& running) {
  ++counts_.frames;
  running_ = running;
  if (!frame.time && !(frame.id && params_.id_bits)) {
    std::vector<Labeled> out;
    tell(frame.token, Fate::untimed, out);
    return out;
  }
  if (frame.time) {
    if (!origin_) origin_ = frame.time;
    if (!waiting_since_) waiting_since_ = frame.time;
    now_ = frame.time;
  }
  TriggerCounter::Frame next{frame.token, std::nullopt, frame.id, frame.image.content};
  if (frame.time) next.time = static_cast<double>(*frame.time - *origin_) / period_;
  waiting_.push_back({frame.token, frame.image, frame.time});
  const auto counted = counter_.push(next, [&](int64_t trigger, const TriggerCounter::Frame&) {
    return contradicts(trigger, frame.image);
  });
  auto out = settle(counted);
  before_ = frame.image;
  return out;
}

std::vector<FrameLabeler::Labeled> FrameLabeler::drain() {
  auto out = settle(counter_.drain());
  end_of_evidence(out);
  tell_all_seen(out);
  return out;
}

std::vector<FrameLabeler::Labeled> FrameLabeler::new_framing() {
  std::vector<Labeled> out;
  end_of_evidence(out);
  tell_all_seen(out);
  seen_.clear();
  confirmed_until_.reset();
  trouble_.reset();
  contradicted_lately_ = 0;
  if (anchor_)  // pictures in the other frame tell nothing of the new one
    for (Waiting& waiting : waiting_) waiting.image = {};
  before_ = {};
  evidence_.new_framing();
  return out;
}

/// No label will come for those that were seen and not told.
void FrameLabeler::tell_all_seen(std::vector<Labeled>& out) {
  for (Seen& seen : seen_)
    if (!std::exchange(seen.told, true)) tell(seen.token, outside(), out);
}

std::vector<FrameLabeler::Labeled> FrameLabeler::settle(const std::vector<Counted>& all) {
  std::vector<Labeled> out;
  for (const Counted& one : all) {
    const auto at = std::find_if(waiting_.begin(), waiting_.end(), [&](const Waiting& waiting) {
      return waiting.token == one.token;
    });
    const Waiting frame = at == waiting_.end() ? Waiting{one.token, {}, {}} : *at;
    if (at != waiting_.end()) waiting_.erase(at);
    counted(one, frame, out);
  }
  if (counter_.epoch() != epoch_) {
    epoch_ = counter_.epoch();
    end_of_evidence(out);
    confirmed_until_.reset();
    trouble_.reset();
    tell_all_seen(out);
    seen_.clear();
    if (anchor_) ++counts_.resynchronizations;
    lose_anchor();
    lost_anchor_.reset();
  }
  return out;
}

void FrameLabeler::counted(const Counted& frame, const Waiting& waiting,
                           std::vector<Labeled>& out) {
  const ImageEvidence& image = waiting.image;
  const bool doubted = std::exchange(unsettled_.doubted, false);
  if (doubted && !unsettled_.frames.empty() && frame.fate == Counted::Fate::off && frame.conflict) {
    // Two frames for one trigger: one of them has a wrong time, and nothing tells which.
    const uint64_t token = unsettled_.frames.back().frame.token;
    unsettled_.frames.pop_back();
    mark_told(token, true);
    --counts_.labeled;
    tell(token, Fate::ambiguous, out);
    tell(frame.token, Fate::ambiguous, out);
    trouble_ = seen_.back().trigger;
    if (counts_.missing) --counts_.missing;
    return;
  }
  if (!confirmable()) release(unsettled_.frames.size(), out);
  if (frame.fate == Counted::Fate::off || frame.fate == Counted::Fate::ambiguous) {
    const Fate fate = frame.late ? Fate::late : Fate::ambiguous;
    tell(frame.token, anchor_ ? fate : outside(), out);
    ++dropped_since_last_;
    if (!seen_.empty()) trouble_ = seen_.back().trigger;
    return;
  }
  if (program_.marker == LightProgram::Marker::none && !begun_) {
    begun_ = true;
    anchor_ = frame.trigger;
    last_ = frame.trigger - 1;
  }
  if (anchor_ && frame.fate == Counted::Fate::trigger && frame.trigger == last_)
    return tell(frame.token, Fate::duplicate, out);
  const size_t history = 2 * static_cast<size_t>(params_.hold) + 16;
  seen_.push_back({frame.token, frame.trigger, image, false, waiting.time});
  if (seen_.size() > history && (seen_.front().told || !anchor_)) {
    if (!seen_.front().told) tell(seen_.front().token, outside(), out);
    seen_.pop_front();
  }
  if (!anchor_) {
    look_for_marker(out);
    return;
  }
  seen_.back().told = true;
  if (frame.fate == Counted::Fate::trigger) {
    label(frame.token, frame.trigger, image, out);
    if (ended_) return end();
    return look_at_suspicion(out);
  }
  const bool again = image.content && image.content == before_.content &&
                     frame.trigger > last_.value_or(frame.trigger);
  if (again) return tell(frame.token, Fate::duplicate, out);
  const bool unconfirmed =
      is_check(program_.kind(program_.at(static_cast<uint64_t>(frame.trigger - *anchor_)))) &&
      std::ranges::any_of(unsettled_.frames,
                          [](const Unconfirmed& one) { return one.frame.fate == Fate::labeled; });
  contradicted_lately_ += unconfirmed ? kNotConfirmed : kContradicted;
  ++dropped_since_last_;
  ++counts_.contradicted;
  wait({{frame.token, Fate::contradicted, 0, {}}, counts_.missing}, out);
  if (contradicted_lately_ >= kTooMuch) {
    ++counts_.resynchronizations;
    revoke();
    lose_anchor();
    return look_for_marker(out);
  }
  if (!confirmable()) release(unsettled_.frames.size(), out);
  if (!unsettled_.suspected && evidence_.bright(image)) unsettled_.suspected = frame.trigger - 1;
  look_at_suspicion(out);
}

void FrameLabeler::label(uint64_t token, int64_t trigger, const ImageEvidence& image,
                         std::vector<Labeled>& out) {
  const int64_t at = trigger - *anchor_;
  if (at < 0) return tell(token, Fate::before_marker, out);
  const Position position = program_.at(static_cast<uint64_t>(at));
  if (position.part == Position::Part::ended) {
    ended_ = true;
    release(unsettled_.frames.size(), out);
    return tell(token, Fate::ended, out);
  }
  if (last_ && trigger == *last_) return tell(token, Fate::duplicate, out);
  if (last_ && trigger < *last_) {
    if (counts_.missing) --counts_.missing;  // it was taken for lost
    return tell(token, Fate::late, out);
  }
  const uint64_t missing = counts_.missing;
  if (last_) {
    const auto between = static_cast<uint64_t>(trigger - *last_ - 1);
    counts_.missing += between - std::min(between, dropped_since_last_);
  }
  dropped_since_last_ = 0;
  last_ = trigger;
  evidence_.find_scale(position, image);
  const bool confirms = evidence_.confirms(position, image);
  const uint32_t agreed = confirms ? kConfirmed : confirmable() ? 0 : kAgreed;
  contradicted_lately_ -= std::min(contradicted_lately_, agreed);
  const bool passes = position.part == Position::Part::marker && position.index == 1;
  if (passes && position.pass > 0 && trigger != found_marker_.value_or(trigger) + 1)
    ++counts_.markers;
  // The one that told the scale may say now that the lights have slipped meanwhile.
  if (!evidence_.contradicts(position, image)) evidence_.learn(position, image);
  ++counts_.labeled;
  const bool told = told_by_neighbors(position);
  wait({{token, Fate::labeled, static_cast<uint64_t>(at), position, start_}, missing}, out);
  const bool alone = unsettled_.frames.size() == 1;
  if (confirms || (confirmable() ? alone && !is_weak(position) : told || params_.id_bits))
    unsettled_.confirmed = unsettled_.frames.size();
  unsettled_.doubted = !told && !params_.id_bits;
  if (unsettled_.suspected) return;
  if (confirms) confirmed_until_ = trigger;
  release_confirmed(out);
}

/// Whether pictures of this step tell nothing.
bool FrameLabeler::is_weak(Position position) const {
  const StepKind kind = program_.kind(position);
  return position.part == Position::Part::step &&
         (kind == StepKind::olat || kind == StepKind::custom);
}

/// Whether a picture of the step before would not be taken for one of this step.
bool FrameLabeler::told_by_neighbors(Position position) const {
  if (!is_weak(position)) return true;
  const auto count = static_cast<uint32_t>(program_.steps.size());
  position.index = (position.index + count - 1) % count;
  return !is_weak(position);
}

}  // namespace inverse
