// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <vector>

#include "kernels/edit_relight_cells.spv.hpp"
#include "kernels/edit_relight_halve.spv.hpp"
#include "kernels/edit_relight_slopes.spv.hpp"
#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"

namespace inverse {

/// Slopes of a surface from its shading alone, by the rule that bright is near (after Khan et al.
/// 2006): a relief h on a coarse grid in which each octave of log shading is as deep as it is wide,
/// followed over time. A guess that suits round objects in soft light.
class Relief {
 public:
  /// Cells along the longer side, at most.
  static constexpr uint32_t kMaxCells = 256;
  /// Of the coarsest level: what is larger is taken for a change of light.
  static constexpr uint32_t kMinCells = 8;

  Relief(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Records the slopes of a plane (R.rgb, S).
  void record(gpu::Commands& commands, const Plane& intrinsic);
  /// Forgets earlier frames.
  void reset() { fresh_ = true; }

  /// dh/dx, dh/dy in a vec4 of each cell.
  const gpu::BufferPtr& slopes() const { return levels_.front().slopes; }
  Extent grid() const { return levels_.front().extent; }
  /// Pixels a cell, along each axis.
  uint32_t factor() const { return factor_; }

 private:
  struct Level {
    Extent extent;
    gpu::BufferPtr heights, slopes;
  };
  Extent extent_;
  uint32_t factor_;
  std::vector<Level> levels_;
  gpu::BufferPtr nothing_;
  gpu::Program<shaders::edit_relight_cells> cells_;
  gpu::Program<shaders::edit_relight_halve> halve_;
  gpu::Program<shaders::edit_relight_slopes> slopes_, coarsest_;
  bool fresh_ = true;
};

}  // namespace inverse
