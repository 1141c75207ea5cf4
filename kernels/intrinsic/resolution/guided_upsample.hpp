// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/intrinsic_resolution_upsample_fit.spv.hpp"
#include "kernels/intrinsic_resolution_upsample_layers.spv.hpp"
#include "kernels/intrinsic_resolution_upsample_sample.spv.hpp"

namespace inverse {

/// Layers of a frame from those of the same frame at half its size (upsample.glsl).
class GuidedUpsample {
 public:
  /// `extent` of the frame. Throws Error(limit).
  GuidedUpsample(const std::shared_ptr<gpu::Device>& device, Extent extent);
  /// `frame` is linear RGB, `half_intrinsic` (R.rgb, S) of half_of(extent), `slope` Role::slope or
  /// null. Writes (R.rgb, S) in the same scale, whose picture is the frame.
  void record(gpu::Commands& commands, const gpu::BufferPtr& frame,
              const gpu::BufferPtr& half_intrinsic, const PlanePtr& slope,
              const gpu::BufferPtr& intrinsic) const;

 private:
  Extent extent_;
  gpu::Program<shaders::intrinsic_resolution_upsample_sample> sample_;
  gpu::Program<shaders::intrinsic_resolution_upsample_fit> fit_;
  gpu::Program<shaders::intrinsic_resolution_upsample_layers> layers_, colored_layers_;
  gpu::BufferPtr samples_, lines_;
};

}  // namespace inverse
