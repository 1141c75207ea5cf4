#pragma once
#include <gst/video/video.h>

#include <optional>

#include "gpu/commands.hpp"
#include "image/convert.hpp"
#include "image/layers.hpp"
#include "picture.hpp"

namespace inverse {

/// What GStreamer says of a frame in memory, in the words of kernels/image. Throws
/// Error(unsupported) where the format or its colorimetry cannot be handled, naming it.
FrameFormat frame_format(const GstVideoInfo& info);

/// From a buffer in system memory to a linear plane.
class FrameInput {
 public:
  explicit FrameInput(const GstVideoInfo& info);
  gpu::BufferPtr make_buffer(const std::shared_ptr<gpu::Device>& device) const;
  void configure(const std::shared_ptr<gpu::Device>& device);
  /// Copies `buffer` into `upload`, which must be idle, and records the conversion into `plane`.
  /// Throws Error(unsupported) where the buffer is shorter than its caps say.
  void record(gpu::Commands& commands, GstBuffer* buffer, const gpu::BufferPtr& upload,
              const Plane& plane) const;

 private:
  GstVideoInfo info_;
  FrameFormat format_;  // on the device: rows padded to words
  std::optional<Unpack> unpack_;
};

/// From planes to a buffer in system memory.
class FrameOutput {
 public:
  /// `linear` writes linear light whatever the caps' transfer curve is.
  explicit FrameOutput(const GstVideoInfo& info, bool linear = false);
  gpu::BufferPtr make_buffer(const std::shared_ptr<gpu::Device>& device) const;
  void configure(const std::shared_ptr<gpu::Device>& device);
  /// Records drawing `picture` into `readback`. Alpha comes from the input layer's w where there is
  /// one.
  void record(gpu::Commands& commands, const Picture& picture, const Layers& layers,
              const gpu::BufferPtr& readback) const;
  /// Copies what was drawn into a writable buffer, once the commands are done.
  void write(const gpu::BufferPtr& readback, GstBuffer* buffer) const;

 private:
  GstVideoInfo info_;
  FrameFormat format_;
  std::optional<Pack> pack_;
};

}  // namespace inverse
