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

/// Lights on DMX universes whose receivers take a source for gone that is silent for 2.5 s, as
/// those of sACN (E131_NETWORK_DATA_LOSS_TIMEOUT) and olad do: what lasts is said again, from a
/// thread.
class RepeatingDriver : public LightDriver {
 public:
  void upload(const LightProgram& program) final;
  void show(uint64_t trigger) final;
  void black() final;

 protected:
  using Levels = std::map<uint32_t, DmxUniverse>;
  /// `first_universe` is the one in which channel 1 is. Destructors have to call black().
  explicit RepeatingDriver(uint32_t first_universe) : first_universe_(first_universe) {}
  /// Called before the first levels of a program; again for each.
  virtual void open() = 0;
  virtual void send(const Levels& levels) = 0;
  /// After the last levels, which were black.
  virtual void end(const Levels& /*black*/) {}

 private:
  void send_colors(std::vector<LightColor> colors);
  void repeat();
  void stop_repeating();

  const uint32_t first_universe_;
  LightProgram program_;
  std::optional<DmxPatch> patch_;
  std::thread repeater_;  // between upload() and black()
  std::mutex mutex_;      // of all that sends
  std::condition_variable woken_;
  std::vector<LightColor> shown_;
  int said_ = 0;  // how often
  std::chrono::steady_clock::time_point next_;
  bool stopping_ = false;
};

}  // namespace inverse
