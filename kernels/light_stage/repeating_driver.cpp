#include "repeating_driver.hpp"

#include <utility>

#include "../error.hpp"

namespace inverse {
namespace {

constexpr std::chrono::milliseconds kRepeat{800};

using Clock = std::chrono::steady_clock;

}  // namespace

void RepeatingDriver::upload(const LightProgram& program) {
  DmxPatch patch(program, first_universe_);
  black();  // universes of another program
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
  const DmxPatch patch = *std::exchange(patch_, {});
  send(patch.levels({}));
  end(patch.levels({}));
}

void RepeatingDriver::send_colors(std::vector<LightColor> colors) {
  std::lock_guard lock(mutex_);
  shown_ = std::move(colors);
  sent_ = Clock::now();
  send(patch_->levels(shown_));
}

void RepeatingDriver::repeat() {
  std::unique_lock lock(mutex_);
  while (!woken_.wait_until(lock, sent_ + kRepeat, [this] { return stopping_; })) {
    if (Clock::now() < sent_ + kRepeat) continue;
    sent_ = Clock::now();
    try {
      send(patch_->levels(shown_));
    } catch (const Error&) {
      // The next show() tells.
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
