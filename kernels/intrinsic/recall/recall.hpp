// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/intrinsic/guide/guide.hpp"
#include "kernels/intrinsic_recall_recall.spv.hpp"

namespace inverse {

/// What is known of a frame's surfaces before it is decomposed. Of the size `extent`, it shows what
/// the frame shows, if that has another size.
struct KnownReflectance {
  Extent extent;
  gpu::BufferPtr reflectance;  ///< vec4 a pixel: ln R; w: confidence, 0…1
  gpu::BufferPtr known_depth;  ///< a scalar a pixel, meters: of these surfaces; 0: nothing is known
  gpu::BufferPtr depth;        ///< the same of the frame
  gpu::BufferPtr valid;        ///< a vec4, x: 0 if none of it counts
  float weight = 0;            ///< of each pixel, against those of the prior
};

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
