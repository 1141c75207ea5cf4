// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>

#include "gst/lightstage/sync/shared/stage_labels.hpp"
#include "kernels/lightstage/controllers/light_driver.hpp"

namespace inverse {

/// Steps the lights of a stage through a program by the pipeline's clock. Its own thread does all
/// that may wait for a controller, so that no state change does; errors there become element
/// errors.
class LightClock {
 public:
  /// Begins to hand the program to the lights. Throws Error for settings that make no sense.
  LightClock(GstElement* element, std::shared_ptr<const StageLabels> labels,
             const LightDriverSettings& settings, double lead_in);
  LightClock(const LightClock&) = delete;
  LightClock& operator=(const LightClock&) = delete;
  /// Lights off. A program that is still being handed over is given up.
  ~LightClock();

  /// To PLAYING: the program starts after the lead-in, in which lights are off, once the lights
  /// have it.
  void play();
  /// Out of PLAYING: lights off. The program starts again with the next `play`.
  void pause();
  /// Whether the program has started since the last `play`.
  bool started() const { return started_; }

 private:
  using Lock = std::unique_lock<std::mutex>;
  void work();
  bool upload();
  void run(uint64_t request);
  void stop_waiting();
  bool asked(uint64_t request) const { return !ending_ && playing_ && requests_ == request; }

  GstElement* element_;
  std::shared_ptr<const StageLabels> labels_;
  std::unique_ptr<LightDriver> driver_;
  double lead_in_;
  std::atomic<bool> started_{false};

  std::mutex mutex_;
  std::condition_variable changed_;
  GstClockID wait_ = nullptr;
  bool uploading_ = false, playing_ = false, ending_ = false;
  uint64_t requests_ = 0;  // to play
  std::thread thread_;
};

}  // namespace inverse
