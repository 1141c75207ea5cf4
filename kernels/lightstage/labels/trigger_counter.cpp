// SPDX-License-Identifier: LGPL-2.1-or-later
#include "trigger_counter.hpp"

#include <algorithm>
#include <cmath>

namespace inverse {
namespace {

constexpr size_t kMaxHypotheses = 24;
constexpr uint32_t kMaxOff = 8;          // consecutive frames; then the clock has jumped
constexpr uint32_t kMaxOffByIds = 4;     // consecutive frames; then the ids count from elsewhere
constexpr int64_t kMaxLate = 64;         // triggers by which a frame may arrive out of order
constexpr double kMaxRateChange = 2e-6;  // of a clock between two measurements
constexpr double kUnbounded = 1e15;      // periods
constexpr int64_t kMeasureAfter = 512, kCheckpointAfter = 8192;  // triggers

}  // namespace

void TriggerCounter::restart() {
  hypotheses_.clear();
  held_.clear();
  ++epoch_;
  off_in_row_ = ambiguous_in_row_ = 0;
  any_time_ = false;
  slow_ = 1 - params_.drift * 1e-6;
  fast_ = 1 + params_.drift * 1e-6;
  skips_zero_possible_ = true;
}

void TriggerCounter::add_if_fitting(const Hypothesis& before, const Frame& frame, int64_t step,
                                    std::vector<Hypothesis>& to) const {
  const auto d = static_cast<double>(step);
  double low = before.low + d * (step >= 0 ? slow_ : fast_);
  double high = before.high + d * (step >= 0 ? fast_ : slow_);
  if (frame.time) {
    low = std::max(low, *frame.time - params_.jitter);
    high = std::min(high, *frame.time + params_.jitter);
    if (low > high) return;
  }
  // A trigger has one image.
  const bool both_known = frame.content && before.content;
  if (step == 0 && both_known && frame.content != before.content) return;
  Hypothesis after = before;
  if (step >= 0 || any_time_) {
    after.low = low;
    after.high = high;
    after.trigger = before.trigger + step;
    after.content = frame.content;
    if (frame.id) {
      after.id = *frame.id;
      after.by_id = true;
    }
  }
  after.held.push_back(before.trigger + step);
  to.push_back(std::move(after));
}

std::vector<TriggerCounter::Hypothesis> TriggerCounter::fitting(const Hypothesis& before,
                                                                const Frame& frame,
                                                                bool use_id) const {
  std::vector<Hypothesis> found;
  if (use_id && frame.id && before.by_id) {
    const uint32_t bits = params_.id_bits;
    const uint64_t mask = bits >= 64 ? ~uint64_t{0} : (uint64_t{1} << bits) - 1;
    const uint64_t ahead = (*frame.id - before.id) & mask, behind = (before.id - *frame.id) & mask;
    const bool late = behind < ahead && (any_time_ || behind <= uint64_t{kMaxLate});
    if (!late && ahead > uint64_t{1} << 40) return found;
    const int64_t step = late ? -static_cast<int64_t>(behind) : static_cast<int64_t>(ahead);
    add_if_fitting(before, frame, step, found);
    // Some cameras skip 0 when ids wrap.
    const bool wrapped = !late && (*frame.id & mask) < (before.id & mask);
    if (wrapped && skips_zero_possible_ && *frame.id)
      add_if_fitting(before, frame, step - 1, found);
    return found;
  }
  if (!frame.time) return found;
  const double x = *frame.time;
  const double min_step = x - params_.jitter - before.high,
               max_step = x + params_.jitter - before.low;
  const double first = min_step / (min_step > 0 ? fast_ : slow_) - 1;
  const double last = max_step / (max_step > 0 ? slow_ : fast_) + 1;
  if (!(std::abs(first) < 1e15 && last - first < 2 * kMaxHypotheses)) return found;
  const auto from = static_cast<int64_t>(std::floor(first));
  const auto to = static_cast<int64_t>(std::ceil(last));
  for (int64_t step = std::max<int64_t>(from, 0); step <= to; ++step)
    add_if_fitting(before, frame, step, found);
  if (found.empty())
    for (int64_t step = std::min<int64_t>(to, -1);
         step >= (any_time_ ? from : std::max(from, -kMaxLate)); --step)
      add_if_fitting(before, frame, step, found);
  return found;
}

std::vector<TriggerCounter::Counted> TriggerCounter::push(const Frame& frame,
                                                          const Contradicts& contradicts) {
  std::vector<Counted> out;
  if (params_.id_bits && frame.id && *frame.id == 0) skips_zero_possible_ = false;
  const bool countable =
      (frame.time && std::isfinite(*frame.time)) || (params_.id_bits && frame.id);
  if (!countable) {
    out.push_back({frame.token, Counted::Fate::off, 0, false});
    return out;
  }
  if (hypotheses_.empty()) {
    Hypothesis first{-kUnbounded, kUnbounded, 0, 0, frame.content, {0}, false};
    if (frame.time) {
      first.low = *frame.time - params_.jitter;
      first.high = *frame.time + params_.jitter;
    }
    if (params_.id_bits && frame.id) {
      first.id = *frame.id;
      first.by_id = true;
    }
    checkpoint_ = {0, first.low, first.high};
    hypotheses_.push_back(first);
    held_.push_back({frame.token, contradicts && contradicts(0, frame)});
    resolve(out);
    return out;
  }
  const bool with_id = params_.id_bits && frame.id;
  std::vector<Hypothesis> next;
  const auto collect = [&](bool use_id) {
    for (const Hypothesis& before : hypotheses_)
      for (Hypothesis& after : fitting(before, frame, use_id)) {
        const auto same = std::find(next.begin(), next.end(), after);
        if (same == next.end()) {
          next.push_back(std::move(after));
        } else {
          same->low = std::min(same->low, after.low);
          same->high = std::max(same->high, after.high);
        }
      }
  };
  collect(with_id);
  // Ids that repeatedly contradict the times: the camera was restarted, or it counts frames and
  // missed triggers. Use the times to find the new offset of the ids.
  if (next.empty() && with_id && off_in_row_ + 1 >= kMaxOffByIds) collect(false);
  if (next.empty()) {
    const Hypothesis& any = hypotheses_.front();
    Frame pictureless = frame;
    pictureless.content = 0;
    std::vector<Hypothesis> same;
    add_if_fitting(any, pictureless, 0, same);
    out.push_back({frame.token, Counted::Fate::off, any.trigger,
                   frame.time && *frame.time > any.high + params_.jitter, !same.empty()});
    if (++off_in_row_ >= kMaxOff) give_up(out);
    return out;
  }
  off_in_row_ = 0;
  any_time_ = false;
  const bool could_be_any = next.size() > kMaxHypotheses;
  bool contradicted = false;
  if (contradicts) {
    std::vector<Hypothesis> agreeing;
    for (const Hypothesis& one : next)
      if (!contradicts(one.held.back(), frame)) agreeing.push_back(one);
    contradicted = agreeing.empty();
    if (!contradicted) next = std::move(agreeing);
  }
  held_.push_back({frame.token, contradicted});
  hypotheses_ = std::move(next);
  if (could_be_any && hypotheses_.size() > kMaxHypotheses) {
    give_up(out);
    return out;
  }
  resolve(out);
  if (hypotheses_.size() == 1) measure_rate();
  return out;
}

/// Reports the frames on which all hypotheses agree, and the oldest if they disagree for too long.
void TriggerCounter::resolve(std::vector<Counted>& out) {
  while (!held_.empty()) {
    const int64_t trigger = hypotheses_.front().held.front();
    const bool agreed = std::all_of(hypotheses_.begin(), hypotheses_.end(),
                                    [&](const Hypothesis& e) { return e.held.front() == trigger; });
    if (!agreed && held_.size() <= params_.hold) return;
    const Held& first = held_.front();
    using Fate = Counted::Fate;
    const Fate fate = !agreed              ? Fate::ambiguous
                      : first.contradicted ? Fate::contradicted
                                           : Fate::trigger;
    out.push_back({first.token, fate, trigger, false});
    ambiguous_in_row_ = agreed ? 0 : ambiguous_in_row_ + 1;
    held_.pop_front();
    for (Hypothesis& e : hypotheses_) e.held.pop_front();
    // Merge hypotheses that differed only in the reported frame.
    for (size_t i = 0; i < hypotheses_.size(); ++i)
      for (size_t j = hypotheses_.size() - 1; j > i; --j)
        if (hypotheses_[i] == hypotheses_[j]) {
          hypotheses_[i].low = std::min(hypotheses_[i].low, hypotheses_[j].low);
          hypotheses_[i].high = std::max(hypotheses_[i].high, hypotheses_[j].high);
          hypotheses_.erase(hypotheses_.begin() + static_cast<ptrdiff_t>(j));
        }
    if (ambiguous_in_row_ > 2 * params_.hold) {
      give_up(out);
      return;
    }
  }
}

void TriggerCounter::give_up(std::vector<Counted>& out) {
  for (const Held& held : held_) out.push_back({held.token, Counted::Fate::ambiguous, 0, false});
  restart();
}

void TriggerCounter::flush() {
  drain();
  any_time_ = true;
}

std::vector<TriggerCounter::Counted> TriggerCounter::drain() {
  std::vector<Counted> out;
  for (const Held& held : held_) out.push_back({held.token, Counted::Fate::ambiguous, 0, false});
  held_.clear();
  for (Hypothesis& e : hypotheses_) e.held.clear();
  if (hypotheses_.size() > 1) restart();
  return out;
}

/// Narrows the bounds of the clock's rate with the time since a checkpoint.
void TriggerCounter::measure_rate() {
  const Hypothesis& now = hypotheses_.front();
  const int64_t passed = now.trigger - checkpoint_.trigger;
  if (passed < 0) checkpoint_ = {now.trigger, now.low, now.high};
  if (passed < kMeasureAfter || passed % (kMeasureAfter / 2) != 0) return;
  const auto count = static_cast<double>(passed);
  const double slow = (now.low - checkpoint_.high) / count;
  const double fast = (now.high - checkpoint_.low) / count;
  const double low = std::max(slow, slow_) - kMaxRateChange,
               high = std::min(fast, fast_) + kMaxRateChange;
  const double bound = params_.drift * 1e-6;
  if (low <= high) {
    slow_ = std::max(low, 1 - bound);
    fast_ = std::min(high, 1 + bound);
  } else {
    slow_ = 1 - bound;
    fast_ = 1 + bound;
  }
  if (passed >= kCheckpointAfter) checkpoint_ = {now.trigger, now.low, now.high};
}

}  // namespace inverse
