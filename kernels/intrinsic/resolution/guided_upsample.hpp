#pragma once
#include <memory>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"

namespace inverse {

/// Layers of a frame from those of the same frame at half its size (upsample.glsl).
class GuidedUpsample {
 public:
  /// `extent` of the frame. Throws Error(limit).
  GuidedUpsample(const std::shared_ptr<gpu::Device>& device, Extent extent);
  /// `frame` is linear RGB, `half_intrinsic` (R.rgb, S) of half_of(extent). Writes (R.rgb, S) with
  /// R S = frame, in the same scale.
  void record(gpu::Commands& commands, const gpu::BufferPtr& frame,
              const gpu::BufferPtr& half_intrinsic, const gpu::BufferPtr& intrinsic) const;

 private:
  Extent extent_;
  gpu::KernelPtr sample_, fit_, layers_;
  gpu::BufferPtr samples_, lines_;
};

}  // namespace inverse
