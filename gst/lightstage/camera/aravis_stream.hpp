// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <functional>
#include <memory>
#include <optional>

#include "aravis_camera.hpp"

namespace inverse {

/// A received frame in GStreamer's layout.
struct CameraFrame {
  GstBuffer* pixels = nullptr;  ///< the taker's
  uint64_t id = 0;              ///< as the camera counts
  uint64_t camera_time = 0;     ///< ns of the camera's clock; 0 if it has none
  int64_t age = 0;              ///< ns since it began to arrive
};

/// The stream of a camera. A frame's memory is lent to the buffer that carries it, and returns to
/// the camera when that is freed, even after the stream has ended. At most half of the frames are
/// lent; further ones are copied, so that the camera always has free memory.
class AravisStream {
 public:
  /// Frames go into `frames` buffers of memory. `arrived` is called from another thread when one
  /// is there. Throws Error.
  AravisStream(AravisCamera& camera, const FrameLayout& layout, uint32_t frames,
               std::function<void()> arrived);
  ~AravisStream();
  AravisStream(const AravisStream&) = delete;
  AravisStream& operator=(const AravisStream&) = delete;

  /// The next complete frame, if there is one. `stale` decides by its age whether to skip it.
  std::optional<CameraFrame> take(const std::function<bool(int64_t age)>& stale);

  struct Counts {
    uint64_t incomplete = 0, misfits = 0, stale = 0, copied = 0, lent = 0;
    uint64_t underruns = 0;  ///< frames that the camera sent and there was no memory for
    uint64_t resent_packets = 0, missing_packets = 0;
  };
  Counts counts() const;
  /// Number of buffers that downstream holds.
  uint32_t lent_now() const;

 private:
  struct Lender;
  GstBuffer* pixels(ArvBuffer* frame);

  FrameLayout layout_;
  ObjectRef<ArvStream> stream_;
  std::shared_ptr<Lender> lender_;
  std::function<void()> arrived_;
  Counts counts_;
};

}  // namespace inverse
