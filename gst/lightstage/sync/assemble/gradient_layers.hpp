// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <memory>

#include "gst/base/frames/frame_io.hpp"
#include "gst/base/vulkan/device_context.hpp"

namespace inverse {

/// Brings pairs of frames to the device, as layers.
class GradientLayers {
 public:
  /// Throws Error if kernels cannot read the frames' format, or if there is no device.
  GradientLayers(const GstVideoInfo& info, const std::shared_ptr<gpu::Device>& device);

  /// A buffer without memory that carries both. Throws Error.
  GstBuffer* make(GstBuffer* a, GstBuffer* b);

 private:
  struct Slot {
    std::unique_ptr<gpu::Commands> commands;
    gpu::BufferPtr a, b;  // the bytes of the frames
  };
  FrameInput input_;
  PlanePool planes_;
  gpu::FrameRing<Slot> slots_;
  size_t next_ = 0;
};

}  // namespace inverse
