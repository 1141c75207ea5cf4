// SPDX-License-Identifier: LGPL-2.1-or-later
#include "rate_controller.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace inverse {
namespace {

std::string milliseconds(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f ms", value);
  return text;
}

}  // namespace

double RateController::Goal::budget_ms() const {
  double budget = std::numeric_limits<double>::infinity();
  if (fps > 0) budget = 1e3 / fps;
  if (latency_ms > 0) budget = std::min(budget, latency_ms);
  return budget;
}

RateController::RateController(std::span<const double> costs)
    : costs_(costs.begin(), costs.end()),
      level_(costs.size() - 1),
      top_(level_),
      trial_wait_(costs.size(), kTrialWait) {}

void RateController::set_goal(const Goal& goal, size_t top) {
  const bool starts = goal.on() && !goal_.on();
  goal_ = goal;
  top_ = std::min(top, costs_.size() - 1);
  if (starts || !goal.on()) {
    level_ = top_;
    clear();
    moved_.reset();
    trial_wait_.assign(costs_.size(), kTrialWait);
    report_ = {};
  } else if (level_ > top_) {
    typical_ = predicted(top_);
    level_ = top_;
    frames_ = 0;
    climbed_.reset();
    room_since_.reset();
  }
  report_.level = level_;
  report_.budget_ms = goal.on() ? goal.budget_ms() : 0;
}

void RateController::clear() {
  frames_ = 0;
  typical_ = 0;
  late_ = 0;
  climbed_.reset();
  room_since_.reset();
}

void RateController::forget() {
  clear();
  start_ = kStart;
  report_.predicted_ms = 0;
}

double RateController::took_but(size_t above) const {
  std::array<double, kWindow> sorted = took_;
  const size_t count = std::min(frames_, kWindow);
  std::sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(count));
  return sorted[count - 1 - above];
}

void RateController::frame(double now_s, double took_ms, size_t level) {
  if (!goal_.on() || level != level_) return;
  if (start_ > 0) {
    --start_;
    return;
  }
  took_[frames_++ % kWindow] = took_ms;
  if (frames_ < kMinFrames) return;
  report_.predicted_ms = typical_ = took_but(std::min(frames_, kWindow) / 2);
  if (climbed_ && now_s - *climbed_ > kTrial) {
    climbed_.reset();
    trial_wait_[level_] = kTrialWait;
  }
  const double budget = goal_.budget_ms();
  if (typical_ > budget && level_ > 0) {
    size_t to = level_ - 1;
    while (to > 0 && predicted(to) > kRoom * budget) --to;
    move(now_s, to, "down: took " + milliseconds(typical_) + " of " + milliseconds(budget));
    return;
  }
  if (level_ == top_ || frames_ < kWindow) return;
  const double above = took_but(1) * costs_[level_ + 1] / costs_[level_];
  if (above > kRoom * budget) {
    room_since_.reset();
    return;
  }
  if (!room_since_) room_since_ = now_s;
  if (now_s - *room_since_ >= trial_wait_[level_ + 1])
    move(now_s, level_ + 1,
         "up: expects " + milliseconds(predicted(level_ + 1)) + " of " + milliseconds(budget));
}

void RateController::late(double now_s, double by_ms) {
  if (!goal_.on()) return;
  if (!(by_ms > 0)) {
    late_ = 0;
    return;
  }
  room_since_.reset();
  if (moved_ && now_s - *moved_ < kEcho) return;
  if (++late_ >= kMinFrames && level_ > 0)
    move(now_s, level_ - 1, "down: " + milliseconds(by_ms) + " late downstream");
}

void RateController::move(double now_s, size_t to, const std::string& reason) {
  if (to > level_) {
    climbed_ = now_s;
  } else if (climbed_) {
    // Whether it was the level itself or the load that grew meanwhile: it did not hold.
    climbed_.reset();
    trial_wait_[level_] = std::min(2 * trial_wait_[level_], kMaxTrialWait);
  }
  report_.predicted_ms = typical_ = predicted(to);
  report_.level = level_ = to;
  report_.reason = reason;
  ++report_.moves;
  frames_ = 0;
  late_ = 0;
  moved_ = now_s;
  room_since_.reset();
}

}  // namespace inverse
