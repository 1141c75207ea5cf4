// SPDX-License-Identifier: LGPL-2.1-or-later
#include "repeating_driver.hpp"

#include <utility>

#include "common/error.hpp"

namespace inverse {
namespace {

// New levels are sent three times at short intervals (E1.31 6.6.2), then at long ones.
constexpr std::chrono::milliseconds kShortInterval{30}, kLongInterval{800};
constexpr int kShortRepeats = 3;

using Clock = std::chrono::steady_clock;

}  // namespace

void RepeatingDriver::upload(const LightProgram& program) {
  DmxPatch patch(program, first_universe_);
  black();  // the universes of the program before
  open();
  patch_.emplace(std::move(patch));
  program_ = program;
  send_colors({});
  repeater_ = std::thread([this] { repeat(); });
}

void RepeatingDriver::show(uint64_t trigger) {
  if (!patch_) throw Error(ErrorKind::internal, "lights are shown before a program is uploaded");
  send_colors(program_.colors(program_.at(trigger)));
}

void RepeatingDriver::black() {
  stop_repeating();
  if (!patch_) return;
  const Levels black = patch_->levels({});
  patch_.reset();
  try {
    send(black);
  } catch (const Error&) {
    end(black);
    throw;
  }
  end(black);
}

void RepeatingDriver::send_colors(std::vector<LightColor> colors) {
  std::lock_guard lock(mutex_);
  shown_ = std::move(colors);
  sends_ = 1;
  next_ = Clock::now() + kShortInterval;
  send(patch_->levels(shown_));
  woken_.notify_all();
}

void RepeatingDriver::repeat() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    if (Clock::now() < next_) {
      woken_.wait_until(lock, next_);
      continue;
    }
    next_ = Clock::now() + (++sends_ < kShortRepeats ? kShortInterval : kLongInterval);
    try {
      send(patch_->levels(shown_));
    } catch (const Error&) {
      // The next show() reports it.
    }
  }
}

void RepeatingDriver::stop_repeating() {
  if (!repeater_.joinable()) return;
  {
    std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  woken_.notify_all();
  repeater_.join();
  stopping_ = false;
}

}  // namespace inverse
