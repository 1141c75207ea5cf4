#include "light_clock.hpp"

#include <algorithm>

#include "base/errors.hpp"

namespace inverse {

LightClock::LightClock(GstElement* element, std::shared_ptr<const StageLabels> labels,
                       const LightDriverSettings& settings, double lead_in)
    : element_(element),
      labels_(std::move(labels)),
      driver_(make_light_driver(settings)),
      lead_in_(lead_in) {
  driver_->upload(labels_->program());
}

LightClock::~LightClock() { pause(); }

void LightClock::play() {
  pause();
  if (!uploaded_) driver_->upload(labels_->program());
  uploaded_ = true;
  GstClock* clock = gst_element_get_clock(element_);
  if (!clock) clock = gst_system_clock_obtain();
  const GstClockTime start = gst_clock_get_time(clock);
  stopping_ = false;
  thread_ = std::thread([this, clock, start] {
    guarded(element_, [&] { run(clock, start); });
    gst_object_unref(clock);
  });
}

void LightClock::run(GstClock* clock, GstClockTime start) {
  const LightProgram& program = labels_->program();
  const auto triggers = program.triggers();
  // Steps begin at whole periods of the running time, as do the frames of cameras that are
  // triggered by the same clock.
  const GstClockTime base = gst_element_get_base_time(element_);
  const GstClockTime first =
      start - std::min(start, base) + static_cast<GstClockTime>(lead_in_ * GST_SECOND);
  const GstClockTime nominator = GST_SECOND * program.rate_denominator;
  const uint64_t before = gst_util_uint64_scale_ceil(first, program.rate_numerator, nominator);
  uint64_t trigger = 0;
  for (; !triggers || trigger < *triggers; ++trigger) {
    // From the program's start, so that nothing adds up.
    const GstClockTime time =
        base + gst_util_uint64_scale(before + trigger, nominator, program.rate_numerator);
    GstClockID wait = nullptr;
    {
      std::lock_guard lock(mutex_);
      if (stopping_) return;
      wait = wait_ = gst_clock_new_single_shot_id(clock, time);
      gst_clock_id_ref(wait);
    }
    gst_clock_id_wait(wait, nullptr);
    gst_clock_id_unref(wait);
    {
      std::lock_guard lock(mutex_);
      gst_clock_id_unref(wait_);
      wait_ = nullptr;
      if (stopping_) return;
    }
    driver_->show(trigger);
  }
  driver_->black();
}

void LightClock::pause() {
  {
    std::lock_guard lock(mutex_);
    stopping_ = true;
    if (wait_) gst_clock_id_unschedule(wait_);
  }
  if (!thread_.joinable()) return;
  thread_.join();
  uploaded_ = false;
  try {
    driver_->black();
  } catch (const std::exception& error) {
    GST_WARNING_OBJECT(element_, "the lights were not switched off: %s", error.what());
  }
}

}  // namespace inverse
