// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/image/components/components.hpp"
#include "kernels/image_strokes_claim.spv.hpp"
#include "kernels/image_strokes_colors.spv.hpp"
#include "kernels/image_strokes_fill.spv.hpp"
#include "kernels/image_strokes_labels.spv.hpp"

namespace inverse {

/// Extends strokes to the connected surroundings of similar reflectance (thesis, 4.5.2, in the
/// picture; tests/reference/intrinsic/strokes.hpp, fill_strokes). Allocates its buffers when it is
/// first used.
class StrokeFill {
 public:
  StrokeFill(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Extends the mask of `count` strokes, with bounds, kind and fill as in strokes.glsl.
  /// `reflectance` is RGB, a vec4 a pixel.
  void record(gpu::Commands& commands, const gpu::BufferPtr& mask, const gpu::BufferPtr& strokes,
              uint32_t count, const gpu::BufferPtr& reflectance);

 private:
  Extent extent_;
  gpu::Program<shaders::image_strokes_colors> average_;
  gpu::Program<shaders::image_strokes_labels> label_;
  gpu::Program<shaders::image_strokes_claim> claim_;
  gpu::Program<shaders::image_strokes_fill> fill_;
  Components components_;
  gpu::BufferPtr colors_, labels_, claims_;
};

}  // namespace inverse
