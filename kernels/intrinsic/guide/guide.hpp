// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/pack4.hpp"
#include "kernels/intrinsic_guide_cells.spv.hpp"
#include "kernels/intrinsic_guide_frame.spv.hpp"
#include "kernels/intrinsic_guide_guide.spv.hpp"
#include "kernels/intrinsic_guide_guide_coarse.spv.hpp"
#include "kernels/intrinsic_guide_statistics.spv.hpp"

namespace inverse {

/// The local cues of a frame that a prior reads (guide.glsl;
/// docs/reference/methods/intrinsicdecomp.md, 1), from linear RGB.
class Guide {
 public:
  /// Throws Error(limit) if the planes do not fit the device.
  Guide(const std::shared_ptr<gpu::Device>& device, Extent extent);
  /// Records the guide of a frame in light of the color `light` (SceneLight::state); null: gray
  /// light.
  void record(gpu::Commands& commands, const gpu::BufferPtr& frame, const gpu::BufferPtr& light);

  Extent extent() const { return extent_; }
  Extent extent1() const { return extent1_; }
  Extent cell_extent() const { return extent2_; }           ///< of level 2
  const gpu::BufferPtr& level0() const { return level0_; }  ///< vec4 a pixel: m, c0, c1, u
  const gpu::BufferPtr& level1() const { return level1_; }  ///< means of 2 x 2
  const gpu::BufferPtr& cells() const {
    return cells_;
  }  ///< level 2, two vec4 a cell of 4 x 4 pixels
  const gpu::BufferPtr& guide_coarse() const {
    return guide_coarse_;
  }  ///< level 4, vec4 a cell of 16 x 16 pixels
  static constexpr uint64_t kStatisticsSize = shaders::intrinsic_guide_frame::STATISTICS_SIZE;
  const gpu::BufferPtr& statistics() const {
    return statistics_;
  }  ///< of the frame, kStatisticsSize vec4 (guide.glsl)

 private:
  Extent extent_, extent1_, extent2_, extent4_;
  gpu::Program<shaders::intrinsic_guide_guide> guide_, colored_guide_;
  gpu::Program<shaders::intrinsic_guide_cells> cells_kernel_;
  gpu::Program<shaders::intrinsic_guide_guide_coarse> guide_coarse_kernel_;
  gpu::Program<shaders::intrinsic_guide_statistics> sum_;
  gpu::Program<shaders::intrinsic_guide_frame> frame_, colored_frame_;
  gpu::BufferPtr level0_, level1_, cells_, guide_coarse_, statistics_;
  gpu::BufferPtr sums_[3];
  bool cleared_ = false;  // the sums' unused slots
};

}  // namespace inverse
