#include "trigger_counter.hpp"

#include <algorithm>
#include <cmath>

namespace inverse {
namespace {

constexpr size_t kMostExplanations = 24;
constexpr uint32_t kOffInRow = 8;       // frames that fit nothing: the clock has jumped
constexpr uint32_t kOffInRowOfIds = 4;  // ids that do not fit the times: they count otherwise now
constexpr int64_t kMostLate = 64;       // triggers by which a frame may arrive out of order
constexpr double kWander = 2e-6;        // by which a clock's rate changes between two measurements
constexpr double kAnyTime = 1e15;       // periods
constexpr int64_t kMeasureAfter = 512, kCheckpointAfter = 8192;  // triggers

}  // namespace

void TriggerCounter::restart() {
  explanations_.clear();
  held_.clear();
  ++epoch_;
  off_in_row_ = unsettled_in_row_ = 0;
  anywhere_ = false;
  slow_ = 1 - params_.drift * 1e-6;
  fast_ = 1 + params_.drift * 1e-6;
  skips_zero_possible_ = true;
}

void TriggerCounter::add_if_fitting(const Explanation& before, const Frame& frame, int64_t step,
                                    std::vector<Explanation>& to) const {
  const auto d = static_cast<double>(step);
  double low = before.low + d * (step >= 0 ? slow_ : fast_);
  double high = before.high + d * (step >= 0 ? fast_ : slow_);
  if (frame.time) {
    low = std::max(low, *frame.time - params_.jitter);
    high = std::min(high, *frame.time + params_.jitter);
    if (low > high) return;
  }
  // Of one trigger there is one picture.
  const bool both_known = frame.content && before.content;
  if (step == 0 && both_known && frame.content != before.content) return;
  Explanation after = before;
  if (step >= 0 || anywhere_) {
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

std::vector<TriggerCounter::Explanation> TriggerCounter::fitting(const Explanation& before,
                                                                 const Frame& frame,
                                                                 bool use_id) const {
  std::vector<Explanation> found;
  if (use_id && frame.id && before.by_id) {
    const uint32_t bits = params_.id_bits;
    const uint64_t mask = bits >= 64 ? ~uint64_t{0} : (uint64_t{1} << bits) - 1;
    const uint64_t ahead = (*frame.id - before.id) & mask, behind = (before.id - *frame.id) & mask;
    const bool late = behind < ahead && (anywhere_ || behind <= uint64_t{kMostLate});
    if (!late && ahead > uint64_t{1} << 40) return found;
    const int64_t step = late ? -static_cast<int64_t>(behind) : static_cast<int64_t>(ahead);
    add_if_fitting(before, frame, step, found);
    // Where ids wrap, some cameras leave out 0.
    const bool wrapped = !late && (*frame.id & mask) < (before.id & mask);
    if (wrapped && skips_zero_possible_ && *frame.id)
      add_if_fitting(before, frame, step - 1, found);
    return found;
  }
  if (!frame.time) return found;
  const double x = *frame.time;
  const double least = x - params_.jitter - before.high, most = x + params_.jitter - before.low;
  const double first = least / (least > 0 ? fast_ : slow_) - 1;
  const double last = most / (most > 0 ? slow_ : fast_) + 1;
  if (!(std::abs(first) < 1e15 && last - first < 2 * kMostExplanations)) return found;
  const auto from = static_cast<int64_t>(std::floor(first));
  const auto to = static_cast<int64_t>(std::ceil(last));
  for (int64_t step = std::max<int64_t>(from, 0); step <= to; ++step)
    add_if_fitting(before, frame, step, found);
  if (found.empty())
    for (int64_t step = std::min<int64_t>(to, -1);
         step >= (anywhere_ ? from : std::max(from, -kMostLate)); --step)
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
  if (explanations_.empty()) {
    Explanation first{-kAnyTime, kAnyTime, 0, 0, frame.content, {0}, false};
    if (frame.time) {
      first.low = *frame.time - params_.jitter;
      first.high = *frame.time + params_.jitter;
    }
    if (params_.id_bits && frame.id) {
      first.id = *frame.id;
      first.by_id = true;
    }
    checkpoint_ = {0, first.low, first.high};
    explanations_.push_back(first);
    held_.push_back({frame.token, contradicts && contradicts(0, frame)});
    settle(out);
    return out;
  }
  const bool with_id = params_.id_bits && frame.id;
  std::vector<Explanation> next;
  const auto collect = [&](bool use_id) {
    for (const Explanation& before : explanations_)
      for (Explanation& after : fitting(before, frame, use_id)) {
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
  // Ids that go on otherwise than times do, again and again: a camera that was started again, or
  // one that counts frames and missed triggers. Times tell from where they count now.
  if (next.empty() && with_id && off_in_row_ + 1 >= kOffInRowOfIds) collect(false);
  if (next.empty()) {
    const Explanation& any = explanations_.front();
    Frame pictureless = frame;
    pictureless.content = 0;
    std::vector<Explanation> same;
    add_if_fitting(any, pictureless, 0, same);
    out.push_back({frame.token, Counted::Fate::off, any.trigger,
                   frame.time && *frame.time > any.high + params_.jitter, !same.empty()});
    if (++off_in_row_ >= kOffInRow) give_up(out);
    return out;
  }
  off_in_row_ = 0;
  anywhere_ = false;
  const bool could_be_any = next.size() > kMostExplanations;
  bool contradicted = false;
  if (contradicts) {
    std::vector<Explanation> agreeing;
    for (const Explanation& one : next)
      if (!contradicts(one.held.back(), frame)) agreeing.push_back(one);
    contradicted = agreeing.empty();
    if (!contradicted) next = std::move(agreeing);
  }
  held_.push_back({frame.token, contradicted});
  explanations_ = std::move(next);
  if (could_be_any && explanations_.size() > kMostExplanations) {
    give_up(out);
    return out;
  }
  settle(out);
  if (explanations_.size() == 1) measure_rate();
  return out;
}

/// Tells of those on which all agree, and of the first where they have disagreed for too long.
void TriggerCounter::settle(std::vector<Counted>& out) {
  while (!held_.empty()) {
    const int64_t trigger = explanations_.front().held.front();
    const bool agreed =
        std::all_of(explanations_.begin(), explanations_.end(),
                    [&](const Explanation& e) { return e.held.front() == trigger; });
    if (!agreed && held_.size() <= params_.hold) return;
    const Held& first = held_.front();
    using Fate = Counted::Fate;
    const Fate fate = !agreed              ? Fate::ambiguous
                      : first.contradicted ? Fate::contradicted
                                           : Fate::trigger;
    out.push_back({first.token, fate, trigger, false});
    unsettled_in_row_ = agreed ? 0 : unsettled_in_row_ + 1;
    held_.pop_front();
    for (Explanation& e : explanations_) e.held.pop_front();
    // Once a frame is gone, explanations that differ only in it are the same.
    for (size_t i = 0; i < explanations_.size(); ++i)
      for (size_t j = explanations_.size() - 1; j > i; --j)
        if (explanations_[i] == explanations_[j]) {
          explanations_[i].low = std::min(explanations_[i].low, explanations_[j].low);
          explanations_[i].high = std::max(explanations_[i].high, explanations_[j].high);
          explanations_.erase(explanations_.begin() + static_cast<ptrdiff_t>(j));
        }
    if (unsettled_in_row_ > 2 * params_.hold) {
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
  anywhere_ = true;
}

std::vector<TriggerCounter::Counted> TriggerCounter::drain() {
  std::vector<Counted> out;
  for (const Held& held : held_) out.push_back({held.token, Counted::Fate::ambiguous, 0, false});
  held_.clear();
  for (Explanation& e : explanations_) e.held.clear();
  if (explanations_.size() > 1) restart();
  return out;
}

/// The rate of the clock, from how far it has come since a checkpoint.
void TriggerCounter::measure_rate() {
  const Explanation& now = explanations_.front();
  const int64_t passed = now.trigger - checkpoint_.trigger;
  if (passed < 0) checkpoint_ = {now.trigger, now.low, now.high};
  if (passed < kMeasureAfter || passed % (kMeasureAfter / 2) != 0) return;
  const auto count = static_cast<double>(passed);
  const double slow = (now.low - checkpoint_.high) / count;
  const double fast = (now.high - checkpoint_.low) / count;
  const double low = std::max(slow, slow_) - kWander, high = std::min(fast, fast_) + kWander;
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
