// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame_labeler.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace inverse {
namespace {

using Position = LightProgram::Position;
using Counted = TriggerCounter::Counted;

// Contradictions add to a score, agreements subtract from it; labels are lost at kMaxScore. A
// contradiction weighs more if frames wait for confirmation.
constexpr uint32_t kContradicted = 2, kNotConfirmed = 3, kAgreed = 1, kConfirmed = 3, kMaxScore = 6;
constexpr double kVisible = 0.2;  // of the mean contribution of one light

TriggerCounter::Params counter_params(const FrameLabeler::Params& params) {
  return {params.jitter, params.drift, params.id_bits, params.hold};
}

/// Whether two positions of a program show the same light.
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
  last_off_.reset();
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
  pending_ = {};
  confirmed_until_.reset();
  last_off_.reset();
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
  pending_ = {};
  last_.reset();
  dropped_since_last_ = contradiction_score_ = 0;
  overdue_reported_ = false;
  waiting_since_ = now_;
}

/// The program has ended; no marker is overdue until it starts again.
void FrameLabeler::end() {
  lose_anchor();
  lost_anchor_.reset();
  ended_ = false;
  over_ = true;
  overdue_reported_ = true;
}

bool FrameLabeler::take_overdue() {
  if (program_.marker == LightProgram::Marker::none) return false;
  if (anchor_ || overdue_reported_ || !waiting_since_ || !now_) return false;
  overdue_reported_ = static_cast<double>(*now_ - *waiting_since_) > params_.marker_timeout * 1e9;
  return overdue_reported_;
}

uint64_t& FrameLabeler::count_of(Fate fate) {
  uint64_t* const counts[] = {&counts_.labeled,   &counts_.duplicates,   &counts_.late,
                              &counts_.ambiguous, &counts_.contradicted, &counts_.before_marker,
                              &counts_.ended,     &counts_.untimed};
  return *counts[static_cast<size_t>(fate)];
}

void FrameLabeler::report(uint64_t token, Fate fate, std::vector<Labeled>& out) {
  ++count_of(fate);
  out.push_back({token, fate, 0, {}});
}

/// Whether an image cannot show the program's step at a trigger.
bool FrameLabeler::contradicts(int64_t trigger, const ImageEvidence& image) const {
  if (!anchor_ || trigger < *anchor_) return false;
  const Position position = program_.at(static_cast<uint64_t>(trigger - *anchor_));
  if (evidence_.contradicts(position, image)) return true;
  // Identical pixels cannot show a different light, if that light would be visible.
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
    report(frame.token, Fate::untimed, out);
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
  auto out = resolve(counted);
  before_ = frame.image;
  return out;
}

std::vector<FrameLabeler::Labeled> FrameLabeler::drain() {
  auto out = resolve(counter_.drain());
  end_of_evidence(out);
  report_all_seen(out);
  return out;
}

std::vector<FrameLabeler::Labeled> FrameLabeler::new_framing() {
  std::vector<Labeled> out;
  end_of_evidence(out);
  report_all_seen(out);
  seen_.clear();
  confirmed_until_.reset();
  last_off_.reset();
  contradiction_score_ = 0;
  if (anchor_)  // levels of the old framing do not apply to the new one
    for (Waiting& waiting : waiting_) waiting.image = {};
  before_ = {};
  evidence_.new_framing();
  return out;
}

/// Reports the remaining frames, which will get no label.
void FrameLabeler::report_all_seen(std::vector<Labeled>& out) {
  for (Seen& seen : seen_)
    if (!std::exchange(seen.reported, true)) report(seen.token, outside(), out);
}

std::vector<FrameLabeler::Labeled> FrameLabeler::resolve(const std::vector<Counted>& all) {
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
    last_off_.reset();
    report_all_seen(out);
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
  const bool uncertain = std::exchange(pending_.uncertain, false);
  if (uncertain && !pending_.frames.empty() && frame.fate == Counted::Fate::off && frame.conflict) {
    // Two frames for one trigger: one has a wrong time, and it is unknown which.
    const uint64_t token = pending_.frames.back().frame.token;
    pending_.frames.pop_back();
    mark_reported(token, true);
    --counts_.labeled;
    report(token, Fate::ambiguous, out);
    report(frame.token, Fate::ambiguous, out);
    last_off_ = seen_.back().trigger;
    if (counts_.missing) --counts_.missing;
    return;
  }
  if (!confirmable()) release(pending_.frames.size(), out);
  if (frame.fate == Counted::Fate::off || frame.fate == Counted::Fate::ambiguous) {
    const Fate fate = frame.late ? Fate::late : Fate::ambiguous;
    report(frame.token, anchor_ ? fate : outside(), out);
    ++dropped_since_last_;
    if (!seen_.empty()) last_off_ = seen_.back().trigger;
    return;
  }
  if (program_.marker == LightProgram::Marker::none && !begun_) {
    begun_ = true;
    anchor_ = frame.trigger;
    last_ = frame.trigger - 1;
  }
  if (anchor_ && frame.fate == Counted::Fate::trigger && frame.trigger == last_)
    return report(frame.token, Fate::duplicate, out);
  const size_t history = 2 * static_cast<size_t>(params_.hold) + 16;
  seen_.push_back({frame.token, frame.trigger, image, false, waiting.time});
  if (seen_.size() > history && (seen_.front().reported || !anchor_)) {
    if (!seen_.front().reported) report(seen_.front().token, outside(), out);
    seen_.pop_front();
  }
  if (!anchor_) {
    find_marker(out);
    return;
  }
  seen_.back().reported = true;
  if (frame.fate == Counted::Fate::trigger) {
    label(frame.token, frame.trigger, image, out);
    if (ended_) return end();
    return check_suspicion(out);
  }
  const bool again = image.content && image.content == before_.content &&
                     frame.trigger > last_.value_or(frame.trigger);
  if (again) return report(frame.token, Fate::duplicate, out);
  const bool unconfirmed =
      is_check(program_.kind(program_.at(static_cast<uint64_t>(frame.trigger - *anchor_)))) &&
      std::ranges::any_of(pending_.frames,
                          [](const Unconfirmed& one) { return one.frame.fate == Fate::labeled; });
  contradiction_score_ += unconfirmed ? kNotConfirmed : kContradicted;
  ++dropped_since_last_;
  ++counts_.contradicted;
  wait({{frame.token, Fate::contradicted, 0, {}}, counts_.missing}, out);
  if (contradiction_score_ >= kMaxScore) {
    ++counts_.resynchronizations;
    revoke();
    lose_anchor();
    return find_marker(out);
  }
  if (!confirmable()) release(pending_.frames.size(), out);
  if (!pending_.suspected && evidence_.bright(image)) pending_.suspected = frame.trigger - 1;
  check_suspicion(out);
}

void FrameLabeler::label(uint64_t token, int64_t trigger, const ImageEvidence& image,
                         std::vector<Labeled>& out) {
  const int64_t at = trigger - *anchor_;
  if (at < 0) return report(token, Fate::before_marker, out);
  const Position position = program_.at(static_cast<uint64_t>(at));
  if (position.part == Position::Part::ended) {
    ended_ = true;
    release(pending_.frames.size(), out);
    return report(token, Fate::ended, out);
  }
  if (last_ && trigger == *last_) return report(token, Fate::duplicate, out);
  if (last_ && trigger < *last_) {
    if (counts_.missing) --counts_.missing;  // it was counted as missing
    return report(token, Fate::late, out);
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
  contradiction_score_ -= std::min(contradiction_score_, agreed);
  const bool passes = position.part == Position::Part::marker && position.index == 1;
  if (passes && position.pass > 0 && trigger != found_marker_.value_or(trigger) + 1)
    ++counts_.markers;
  // After find_scale the same image may show that the labels are off.
  if (!evidence_.contradicts(position, image)) evidence_.learn(position, image);
  ++counts_.labeled;
  const bool distinct = distinct_from_previous(position);
  wait({{token, Fate::labeled, static_cast<uint64_t>(at), position, start_}, missing}, out);
  const bool alone = pending_.frames.size() == 1;
  if (confirms || (confirmable() ? alone && !is_weak(position) : distinct || params_.id_bits))
    pending_.confirmed = pending_.frames.size();
  pending_.uncertain = !distinct && !params_.id_bits;
  if (pending_.suspected) return;
  if (confirms) confirmed_until_ = trigger;
  release_confirmed(out);
}

/// Whether images cannot confirm this step.
bool FrameLabeler::is_weak(Position position) const {
  const StepKind kind = program_.kind(position);
  return position.part == Position::Part::step &&
         (kind == StepKind::olat || kind == StepKind::custom);
}

/// Whether an image of the step before would contradict this step.
bool FrameLabeler::distinct_from_previous(Position position) const {
  if (!is_weak(position)) return true;
  const auto count = static_cast<uint32_t>(program_.steps.size());
  position.index = (position.index + count - 1) % count;
  return !is_weak(position);
}

}  // namespace inverse
