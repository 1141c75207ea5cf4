// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/camera/known_reflectance.hpp"
#include "kernels/intrinsic/guide/guide.hpp"
#include "kernels/intrinsic_recall_recall.spv.hpp"

namespace inverse {

/// The stabilization of a frame's reflectance by what is known (Eq. 4.8), on cells of 4 x 4 pixels.
class Recall {
 public:
  /// `cells`: of the guide.
  Recall(const std::shared_ptr<gpu::Device>& device, Extent cells);
  /// Records the sum of the prior's `value` of cells and of what is known. `scale`: OutputScale's,
  /// of the frame before. Returns it, as the prior's.
  const gpu::BufferPtr& record(gpu::Commands& commands, const Guide& guide,
                               const gpu::BufferPtr& value, const gpu::BufferPtr& scale,
                               const KnownReflectance& known);

 private:
  gpu::Program<shaders::intrinsic_recall_recall> recall_;
  gpu::BufferPtr value_;
};

}  // namespace inverse
