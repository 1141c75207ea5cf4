#pragma once
#include <gst/gst.h>

#include <memory>
#include <mutex>
#include <thread>

#include "light_stage/light_driver.hpp"
#include "stage_labels.hpp"

namespace inverse {

/// Steps the lights of a stage through a program by the pipeline's clock.
class LightClock {
 public:
  /// Opens the driver and hands it the program; throws Error, within the driver's patience.
  LightClock(GstElement* element, std::shared_ptr<const StageLabels> labels,
             const LightDriverSettings& settings, double lead_in);
  LightClock(const LightClock&) = delete;
  LightClock& operator=(const LightClock&) = delete;
  ~LightClock();

  /// To PLAYING: the program starts after the lead-in, in which lights are off. What goes wrong
  /// later is an element error. Throws Error as the constructor does.
  void play();
  /// Out of PLAYING: lights off. The program starts anew with the next `play`.
  void pause();

 private:
  void run(GstClock* clock, GstClockTime start);

  GstElement* element_;
  std::shared_ptr<const StageLabels> labels_;
  std::unique_ptr<LightDriver> driver_;
  double lead_in_;
  std::thread thread_;
  std::mutex mutex_;
  GstClockID wait_ = nullptr;
  bool stopping_ = false, uploaded_ = true;
};

}  // namespace inverse
