// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "kernels/intrinsic/guide/guide.hpp"
#include "kernels/intrinsic_strokes_cells.spv.hpp"
#include "kernels/intrinsic_strokes_edges.spv.hpp"
#include "kernels/intrinsic_strokes_means.spv.hpp"
#include "kernels/intrinsic_strokes_residuals.spv.hpp"
#include "kernels/intrinsic_strokes_values.spv.hpp"
#include "stroke_fill.hpp"
#include "stroke_mask.hpp"

namespace inverse {

/// The user's strokes in the linear system of a picture: changes what a prior has written so that
/// each stroke gets one shading, or one reflectance (tests/reference/intrinsic/strokes.hpp).
class Strokes {
 public:
  Strokes(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Draws these strokes from now on; null: none.
  void set(gpu::Commands& commands, const StrokesPtr& list);
  /// Those that were set last; null: none.
  const StrokesPtr& list() const { return list_; }
  /// Forgets them, also how far they extend.
  void forget() {
    list_.reset();
    count_ = 0;
    unfilled_ = false;
  }
  /// Whether strokes are yet to be extended to surroundings of similar reflectance.
  bool unfilled() const { return unfilled_; }
  /// Extends those, by the reflectance that was found with them: RGB, a vec4 a pixel.
  void fill(gpu::Commands& commands, const gpu::BufferPtr& reflectance);
  bool empty() const { return count_ == 0; }
  uint32_t count() const { return count_; }
  /// Of every pixel, as StrokeMask::pixels; null if there never were strokes.
  const gpu::BufferPtr& mask() const { return mask_; }

  /// Records the change of edges that the prior has just written: those of listed tiles, or all.
  /// Buffers as in EdgePrior::Target.
  void record_edges(gpu::Commands& commands, const Guide& guide, const gpu::BufferPtr& system,
                    const gpu::BufferPtr& flux, const TileList* listed) const;
  /// So for the values of cells.
  void record_values(gpu::Commands& commands, const Guide& guide, const gpu::BufferPtr& value,
                     const TileList* listed) const;
  /// Measures how far a solution is from one value in every stroke.
  void record_residuals(gpu::Commands& commands, const Guide& guide,
                        const gpu::BufferPtr& shading) const;
  /// What that wrote, a vec4 a stroke, for `rms_of`.
  const gpu::BufferPtr& residuals() const { return residuals_; }
  /// The rms deviation of ln shading, or of ln reflectance, in a stroke; 0 if it covers nothing.
  static float rms_of(std::span<const float, 4> residual);

 private:
  void write_strokes(gpu::Commands& commands);
  void find_shares(gpu::Commands& commands);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_, cells_;
  gpu::Program<shaders::intrinsic_strokes_cells> share_;
  gpu::Program<shaders::intrinsic_strokes_means> average_;
  gpu::Program<shaders::intrinsic_strokes_residuals> measure_;
  TileProgram<shaders::intrinsic_strokes_edges> edges_;
  TileProgram<shaders::intrinsic_strokes_values> values_;
  StrokeFill fill_;
  StrokesPtr list_;
  std::vector<StrokeMask::Bounds> bounds_;
  gpu::BufferPtr mask_, cell_mask_, strokes_, means_, residuals_;
  uint32_t count_ = 0;
  bool unfilled_ = false;
};

}  // namespace inverse
