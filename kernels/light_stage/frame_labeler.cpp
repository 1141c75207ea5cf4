#include "frame_labeler.hpp"

#include <algorithm>
#include <cmath>

namespace inverse {
namespace {

using Position = LightProgram::Position;
using Counted = TriggerCounter::Counted;

constexpr uint32_t kContradicted = 2, kAgreed = 1, kTooMuch = 6;  // contradictions against labels
constexpr double kVisible = 0.2;                                  // of what a light adds on average

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
  doubted_.reset();
  waiting_.clear();
  origin_.reset();
  waiting_since_.reset();
  epoch_ = counter_.epoch();
}

void FrameLabeler::flush() {
  counter_.flush();
  waiting_.clear();
  seen_.clear();
  doubted_.reset();
  last_.reset();
  dropped_since_last_ = 0;
  if (counter_.epoch() == epoch_) return;
  epoch_ = counter_.epoch();
  lose_anchor();
}

void FrameLabeler::lose_anchor() {
  anchor_.reset();
  last_.reset();
  dropped_since_last_ = contradicted_lately_ = 0;
  overdue_told_ = false;
  waiting_since_ = now_;
}

/// The program is over. Who starts it again has all the time there is.
void FrameLabeler::end() {
  lose_anchor();
  ended_ = false;
  overdue_told_ = true;
}

bool FrameLabeler::take_overdue() {
  if (anchor_ || overdue_told_ || !waiting_since_ || !now_) return false;
  overdue_told_ = static_cast<double>(*now_ - *waiting_since_) > params_.marker_within * 1e9;
  return overdue_told_;
}

void FrameLabeler::tell(uint64_t token, Fate fate, std::vector<Labeled>& out) {
  uint64_t* const counts[] = {&counts_.labeled,   &counts_.duplicates,   &counts_.late,
                              &counts_.ambiguous, &counts_.contradicted, &counts_.before_marker,
                              &counts_.ended,     &counts_.untimed};
  ++*counts[static_cast<size_t>(fate)];
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

std::vector<FrameLabeler::Labeled> FrameLabeler::push(const Frame& frame) {
  ++counts_.frames;
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
  waiting_.emplace_back(frame.token, frame.image);
  const auto counted = counter_.push(next, [&](int64_t trigger, const TriggerCounter::Frame&) {
    return contradicts(trigger, frame.image);
  });
  auto out = settle(counted);
  before_ = frame.image;
  return out;
}

std::vector<FrameLabeler::Labeled> FrameLabeler::drain() {
  auto out = settle(counter_.drain());
  release_doubted(out);
  for (Seen& seen : seen_)
    if (!seen.told) {
      tell(seen.token, Fate::before_marker, out);
      seen.told = true;
    }
  return out;
}

std::vector<FrameLabeler::Labeled> FrameLabeler::settle(const std::vector<Counted>& all) {
  std::vector<Labeled> out;
  for (const Counted& one : all) {
    const auto at = std::find_if(waiting_.begin(), waiting_.end(),
                                 [&](const auto& waiting) { return waiting.first == one.token; });
    const ImageEvidence image = at == waiting_.end() ? ImageEvidence{} : at->second;
    if (at != waiting_.end()) waiting_.erase(at);
    counted(one, image, out);
  }
  if (counter_.epoch() != epoch_) {
    epoch_ = counter_.epoch();
    for (Seen& seen : seen_)
      if (!seen.told) tell(seen.token, Fate::before_marker, out);
    seen_.clear();
    if (anchor_) ++counts_.resynchronizations;
    lose_anchor();
  }
  return out;
}

void FrameLabeler::counted(const Counted& frame, const ImageEvidence& image,
                           std::vector<Labeled>& out) {
  if (doubted_ && frame.fate == Counted::Fate::off && frame.conflict) {
    // Two frames for one trigger: one of them has a wrong time, and nothing tells which.
    const uint64_t token = doubted_->token;
    doubted_.reset();
    --counts_.labeled;
    tell(token, Fate::ambiguous, out);
    tell(frame.token, Fate::ambiguous, out);
    if (counts_.missing) --counts_.missing;
    return;
  }
  release_doubted(out);
  if (frame.fate == Counted::Fate::off || frame.fate == Counted::Fate::ambiguous) {
    const Fate fate = frame.late ? Fate::late : Fate::ambiguous;
    tell(frame.token, anchor_ ? fate : Fate::before_marker, out);
    ++dropped_since_last_;
    return;
  }
  if (program_.marker == LightProgram::Marker::none && !anchor_) {
    anchor_ = frame.trigger;
    last_ = frame.trigger - 1;
  }
  const size_t history = 2 * static_cast<size_t>(params_.hold) + 16;
  seen_.push_back({frame.token, frame.trigger, image, false});
  if (seen_.size() > history) {
    if (!seen_.front().told) tell(seen_.front().token, Fate::before_marker, out);
    seen_.pop_front();
  }
  if (!anchor_) {
    look_for_marker(out);
    return;
  }
  seen_.back().told = true;
  if (frame.fate == Counted::Fate::trigger) {
    label(frame.token, frame.trigger, image, out);
    if (ended_) end();
    return;
  }
  const bool again = image.content && image.content == before_.content &&
                     frame.trigger > last_.value_or(frame.trigger);
  tell(frame.token, again ? Fate::duplicate : Fate::contradicted, out);
  if (again) return;
  ++dropped_since_last_;
  contradicted_lately_ += kContradicted;
  if (contradicted_lately_ < kTooMuch) return;
  ++counts_.resynchronizations;
  lose_anchor();
  look_for_marker(out);
}

void FrameLabeler::label(uint64_t token, int64_t trigger, const ImageEvidence& image,
                         std::vector<Labeled>& out) {
  release_doubted(out);
  const int64_t at = trigger - *anchor_;
  if (at < 0) return tell(token, Fate::before_marker, out);
  const Position position = program_.at(static_cast<uint64_t>(at));
  if (position.part == Position::Part::ended) {
    ended_ = true;
    return tell(token, Fate::ended, out);
  }
  if (last_ && trigger == *last_) return tell(token, Fate::duplicate, out);
  if (last_ && trigger < *last_) {
    if (counts_.missing) --counts_.missing;  // it was taken for lost
    return tell(token, Fate::late, out);
  }
  if (last_) {
    const auto between = static_cast<uint64_t>(trigger - *last_ - 1);
    counts_.missing += between - std::min(between, dropped_since_last_);
  }
  dropped_since_last_ = 0;
  last_ = trigger;
  contradicted_lately_ -= std::min(contradicted_lately_, kAgreed);
  if (position.part == Position::Part::marker && position.index == 1 && position.pass > 0)
    ++counts_.markers;
  evidence_.learn(position, image);
  tell(token, Fate::labeled, out);
  out.back().trigger = static_cast<uint64_t>(at);
  out.back().position = position;
  if (params_.id_bits || checked_by_picture(position)) return;
  doubted_ = out.back();
  out.pop_back();
}

/// Whether a frame of the step before would be told by its picture.
bool FrameLabeler::checked_by_picture(Position position) const {
  if (position.part != Position::Part::step) return true;
  const StepKind kind = program_.kind(position);
  const auto weak = [](StepKind one) { return one == StepKind::olat || one == StepKind::custom; };
  if (!weak(kind)) return true;
  const auto count = static_cast<uint32_t>(program_.steps.size());
  return !weak(program_.steps[(position.index + count - 1) % count].kind);
}

void FrameLabeler::release_doubted(std::vector<Labeled>& out) {
  if (!doubted_) return;
  out.push_back(*doubted_);
  doubted_.reset();
}

}  // namespace inverse
