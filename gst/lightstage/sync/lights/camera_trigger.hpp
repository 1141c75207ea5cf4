// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <memory>
#include <string>

#include "kernels/lightstage/triggers/triggered_capture.hpp"

namespace inverse {

/// The camera somewhere upstream of a pad, fired by software: an element that has a readable
/// property `camera` of type ArvCamera, as lightstagearavissrc and aravissrc do. All throws Error;
/// without Aravis in the build, `find` does.
class CameraTrigger final : public TriggeredCamera {
 public:
  /// Searches through queues, converters and bins. Throws Error(unsupported) if there is none.
  static std::unique_ptr<CameraTrigger> find(GstPad* sink);
  ~CameraTrigger() override;
  CameraTrigger(const CameraTrigger&) = delete;
  CameraTrigger& operator=(const CameraTrigger&) = delete;

  /// Before the source starts: it will not run freely.
  void prepare();
  /// Once its caps have come, so that the camera is open and sends: sets it to wait for triggers.
  /// Throws Error(unsupported) if the camera has no software trigger.
  void configure();

  /// No more frames are wanted: end of stream after those that are there.
  void end();

  std::string name() const override;
  void fire() override;
  uint32_t frame_id_bits() const override;
  /// Whether PTS are when frames began to arrive, in running time.
  bool has_times() const;

 private:
  struct Camera;
  explicit CameraTrigger(GstElement* source);

  GstElement* source_;
  bool set_source_ = false;  ///< its trigger-source, which was empty
  std::unique_ptr<Camera> camera_;
};

}  // namespace inverse
