// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/intrinsic_resolution_compare.spv.hpp"
#include "kernels/solve_total.spv.hpp"

namespace inverse {

/// Distance of two decompositions of a frame: root mean square of the difference of log shading,
/// natural log units, one common factor removed, over pixels weighted by I / (I + 0.02), I the mean
/// channel, since dark pixels show neither layer (compare.comp).
class LayerDistance {
 public:
  LayerDistance(const std::shared_ptr<gpu::Device>& device, Extent extent);
  /// Records the comparison of two intrinsic planes (R.rgb, S) of `frame` as number `slot` of
  /// kFramesInFlight.
  void record(gpu::Commands& commands, const gpu::BufferPtr& frame, const gpu::BufferPtr& one,
              const gpu::BufferPtr& other, uint64_t slot);
  /// The distance recorded in a slot, once its Commands have been waited for.
  float value(uint64_t slot) const;

 private:
  Extent extent_;
  gpu::Program<shaders::intrinsic_resolution_compare> compare_;
  gpu::Program<shaders::solve_total> total_;
  gpu::BufferPtr sums_, sum_;
  gpu::FrameRing<gpu::BufferPtr> found_;
  bool cleared_ = false;  // the sums' unused slots
};

}  // namespace inverse
