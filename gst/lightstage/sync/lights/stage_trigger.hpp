// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "camera_trigger.hpp"
#include "gst/lightstage/sync/shared/stage_labels.hpp"

namespace inverse {

/// Triggers the cameras for lightstagesync: finds them upstream, steps the lights, and gives each
/// frame that arrives its trigger. Thread-safe.
class StageTrigger {
 public:
  struct Settings {
    LightDriverSettings lights;
    TriggeredCapture::Params capture;
  };

  /// Finds the cameras of these sink pads, which have not started yet. Throws Error. The lights are
  /// made ready meanwhile; that this fails is an element error.
  StageTrigger(GstElement* element, std::shared_ptr<const StageLabels> labels,
               const Settings& settings, const std::map<uint32_t, GstPad*>& sinks);
  /// Lights off; cameras are given back. A program that is still being handed over is given up.
  ~StageTrigger();
  StageTrigger(const StageTrigger&) = delete;
  StageTrigger& operator=(const StageTrigger&) = delete;

  /// The caps of a camera have come: it is open. Triggers begin once all are, and the lights have
  /// the program. Throws Error.
  void camera_ready(uint32_t number);
  void set_playing(bool playing);

  /// While one exists, a frame is being handled, and the next one is not triggered.
  class Handling {
   public:
    Handling(StageTrigger& trigger, uint32_t number, GstBuffer* buffer);
    Handling(const Handling&) = delete;
    Handling& operator=(const Handling&) = delete;
    ~Handling();
    /// The frame's, or nothing if it is of none.
    const std::optional<uint64_t>& trigger() const { return label_; }

   private:
    std::shared_ptr<TriggeredCapture> capture_;
    size_t index_ = 0;
    std::optional<uint64_t> label_;
  };

  /// Adds its counts to an element's stats.
  void add_stats(GstStructure* stats) const;

 private:
  struct Camera {
    uint32_t number = 0;
    std::unique_ptr<CameraTrigger> trigger;
    bool ready = false;
  };
  using Lock = std::unique_lock<std::mutex>;
  std::optional<double> age(const CameraTrigger& camera, GstBuffer* buffer) const;
  void upload();
  void begin();
  TriggeredCapture::Listener listener();
  void report_lost(uint64_t trigger, const std::vector<size_t>& cameras) const;

  GstElement* element_;
  std::shared_ptr<const StageLabels> labels_;
  const Settings settings_;
  std::unique_ptr<LightDriver> lights_;

  mutable std::mutex mutex_;
  std::vector<Camera> cameras_;
  std::shared_ptr<TriggeredCapture> capture_;
  bool playing_ = false, uploaded_ = false, ending_ = false;
  uint64_t next_ = 0;
  std::thread uploader_;
};

}  // namespace inverse
