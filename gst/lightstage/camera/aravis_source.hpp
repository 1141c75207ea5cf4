// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>

#include "aravis_stream.hpp"
#include "kernels/lightstage/triggers/camera_clock.hpp"
#include "kernels/lightstage/triggers/frame_ids.hpp"

namespace inverse {

/// The implementation of lightstagearavissrc: a camera, its frames, their numbers and times.
/// Aravis' threads have references to it, too.
struct AravisSource : std::enable_shared_from_this<AravisSource> {
  using Lock = std::unique_lock<std::mutex>;

  /// Opens the camera. Throws Error.
  void open();
  void close();
  /// Makes the camera send frames of these caps. Throws Error.
  void begin(const GstCaps* caps);
  /// Not with the mutex locked: the stream's thread may wait for it.
  void end();
  /// Waits for the next frame of `element`. Flushing, or throws Error.
  GstFlowReturn next(GstElement* element, GstBuffer** buffer);
  void set_flushing(bool flush);

  /// The open camera, and whether it is triggered.
  std::pair<std::shared_ptr<AravisCamera>, bool> opened();
  GstStructure* stats();

  std::mutex mutex;  ///< of all below
  std::condition_variable changed;
  std::string camera_name;
  CameraSettings settings;
  guint buffers = 16, timeout = 2000;
  std::shared_ptr<AravisCamera> camera;
  std::unique_ptr<AravisStream> stream;
  FrameLayout layout;
  uint32_t id_bits = 0;

 private:
  GstBuffer* finish(GstElement* element, const CameraFrame& frame, int64_t now);
  void report_incomplete(GstElement* element, Lock& lock);

  GstCaps* reference_ = nullptr;  ///< of GstReferenceTimestampMeta
  CameraClock clock_;
  FrameIds ids_{16};
  AravisStream::Counts before_;  ///< of streams that ended
  uint64_t frames_ = 0, missed_ = 0, timeouts_ = 0, reported_ = 0;
  bool flushing_ = false, lost_ = false;
};

}  // namespace inverse
