// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "dmx_levels.hpp"
#include "light_driver.hpp"

namespace inverse {

/// Sends DMX levels, and repeats them from a thread while they last. Receivers of sACN
/// (E131_NETWORK_DATA_LOSS_TIMEOUT) and olad drop a source after 2.5 s without packets.
class RepeatingDriver : public LightDriver {
 public:
  void upload(const LightProgram& program) final;
  void show(uint64_t trigger) final;
  void black() final;

 protected:
  using Levels = std::map<uint32_t, DmxUniverse>;
  /// `first_universe`: universe of channel 1. Destructors of subclasses must call black().
  explicit RepeatingDriver(uint32_t first_universe) : first_universe_(first_universe) {}
  /// Called before the first levels of every program.
  virtual void open() = 0;
  virtual void send(const Levels& levels) = 0;
  /// Called after the last levels, which were black.
  virtual void end(const Levels& /*black*/) {}

 private:
  void send_colors(std::vector<LightColor> colors);
  void repeat();
  void stop_repeating();

  const uint32_t first_universe_;
  LightProgram program_;
  std::optional<DmxPatch> patch_;
  std::thread repeater_;  // between upload() and black()
  std::mutex mutex_;      // guards everything that sends
  std::condition_variable woken_;
  std::vector<LightColor> shown_;
  int sends_ = 0;  // of shown_
  std::chrono::steady_clock::time_point next_;
  bool stopping_ = false;
};

}  // namespace inverse
