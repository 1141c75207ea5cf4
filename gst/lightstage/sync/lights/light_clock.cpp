// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_clock.hpp"

#include <algorithm>

#include "gst/base/log/errors.hpp"
#include "gst/base/log/log.hpp"
#include "light_upload.hpp"

namespace inverse {

LightClock::LightClock(GstElement* element, std::shared_ptr<const StageLabels> labels,
                       const LightDriverSettings& settings, double lead_in)
    : element_(element),
      labels_(std::move(labels)),
      driver_(make_light_driver(settings)),
      lead_in_(lead_in),
      thread_([this] { work(); }) {}

LightClock::~LightClock() {
  {
    Lock lock(mutex_);
    ending_ = true;
    // Only then: switching the lights off is waited for.
    if (uploading_) driver_->cancel();
    stop_waiting();
  }
  thread_.join();
}

void LightClock::play() {
  Lock lock(mutex_);
  playing_ = true;
  started_ = false;
  ++requests_;
  stop_waiting();
}

void LightClock::pause() {
  Lock lock(mutex_);
  playing_ = false;
  stop_waiting();
}

/// With the mutex locked.
void LightClock::stop_waiting() {
  if (wait_) gst_clock_id_unschedule(wait_);
  changed_.notify_all();
}

/// Whether the lights have the program; that they do not was an error.
bool LightClock::upload() {
  {
    Lock lock(mutex_);
    if (ending_) return false;
    uploading_ = true;
  }
  const bool good = upload_program(element_, *driver_, labels_->program(), [this] {
    const Lock lock(mutex_);
    return ending_;
  });
  const Lock lock(mutex_);
  uploading_ = false;
  return good;
}

void LightClock::work() {
  bool ready = upload();
  uint64_t done = 0;
  Lock lock(mutex_);
  while (!ending_) {
    if (!asked(requests_) || requests_ == done) {
      changed_.wait(lock);
      continue;
    }
    done = requests_;
    lock.unlock();
    // After black() it needs another start, and after an error another try.
    if (ready || upload()) guarded(element_, [&] { run(done); });
    ready = false;
    try {
      driver_->black();
    } catch (const std::exception& error) {
      GST_CAT_WARNING_OBJECT(log_of(GST_ELEMENT(element_)).category, element_,
                             "the lights were not switched off: %s", error.what());
    }
    lock.lock();
  }
}

void LightClock::run(uint64_t request) {
  const LightProgram& program = labels_->program();
  const auto triggers = program.triggers();
  GstClock* clock = gst_element_get_clock(element_);
  if (!clock) clock = gst_system_clock_obtain();
  const std::unique_ptr<GstClock, void (*)(void*)> held(clock, gst_object_unref);
  const GstClockTime start = gst_clock_get_time(clock);
  // Steps begin at whole periods of the running time, as do the frames of cameras that are
  // triggered by the same clock.
  const GstClockTime base = gst_element_get_base_time(element_);
  const GstClockTime first =
      start - std::min(start, base) + static_cast<GstClockTime>(lead_in_ * GST_SECOND);
  const GstClockTime nominator = GST_SECOND * program.rate_denominator;
  const uint64_t before = gst_util_uint64_scale_ceil(first, program.rate_numerator, nominator);
  for (uint64_t trigger = 0; !triggers || trigger < *triggers; ++trigger) {
    // From the program's start, so that errors do not accumulate.
    const GstClockTime time =
        base + gst_util_uint64_scale(before + trigger, nominator, program.rate_numerator);
    GstClockID wait = nullptr;
    {
      Lock lock(mutex_);
      if (!asked(request)) return;
      wait = wait_ = gst_clock_new_single_shot_id(clock, time);
    }
    gst_clock_id_wait(wait, nullptr);
    {
      Lock lock(mutex_);
      gst_clock_id_unref(wait);
      wait_ = nullptr;
      if (!asked(request)) return;
      started_ = true;
    }
    driver_->show(trigger);
  }
  driver_->black();
}

}  // namespace inverse
