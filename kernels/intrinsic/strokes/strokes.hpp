// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <span>

#include "kernels/image/strokes/stroke_mask.hpp"
#include "kernels/intrinsic/guide/guide.hpp"
#include "kernels/intrinsic_strokes_cells.spv.hpp"
#include "kernels/intrinsic_strokes_edges.spv.hpp"
#include "kernels/intrinsic_strokes_means.spv.hpp"
#include "kernels/intrinsic_strokes_residuals.spv.hpp"
#include "kernels/intrinsic_strokes_values.spv.hpp"

namespace inverse {

/// The user's strokes in the linear system of a picture: changes what a prior has written so that
/// each stroke gets one shading, or one reflectance (tests/reference/intrinsic/strokes.hpp).
class Strokes {
 public:
  Strokes(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Draws these strokes from now on; null: none.
  void set(gpu::Commands& commands, const StrokesPtr& list, const StrokeMask::Places& places);
  /// Forgets them, also how far they extend.
  void forget() { mask_.forget(); }
  /// What of the picture they cover, and where they are.
  const StrokeMask& mask() const { return mask_; }
  /// As those of the mask.
  void fill(gpu::Commands& commands, const StrokeMask::Reflectance& of, const SeenStrokes* seen);
  void follow(gpu::Commands& commands, const StrokeMask::Reflectance& of, const SeenStrokes* seen);
  /// Of every tile, whether the mask changed there with `follow` in this frame; null if it did not.
  const gpu::BufferPtr& changed() const { return followed_ ? mask_.changed() : nothing_; }
  bool empty() const { return mask_.empty(); }
  uint32_t count() const { return mask_.count(); }

  /// Records the change of edges that the prior has just written: those of listed tiles, or all.
  /// Buffers as in EdgePrior::Target.
  void record_edges(gpu::Commands& commands, const Guide& guide, const gpu::BufferPtr& system,
                    const gpu::BufferPtr& flux, const TileList* listed) const;
  /// So for the values of cells.
  void record_values(gpu::Commands& commands, const Guide& guide,
                     const gpu::BufferPtr& value) const;
  /// Measures how far a solution is from one value in every stroke.
  void record_residuals(gpu::Commands& commands, const Guide& guide,
                        const gpu::BufferPtr& shading) const;
  /// What that wrote, a vec4 a stroke, for `rms_of`.
  const gpu::BufferPtr& residuals() const { return residuals_; }
  /// The rms deviation of ln shading, or of ln reflectance, in a stroke; 0 if it covers nothing.
  static float rms_of(std::span<const float, 4> residual);

 private:
  void find_shares(gpu::Commands& commands);

  Extent extent_, cells_;
  gpu::Program<shaders::intrinsic_strokes_cells> share_;
  gpu::Program<shaders::intrinsic_strokes_means> average_;
  gpu::Program<shaders::intrinsic_strokes_residuals> measure_;
  TileProgram<shaders::intrinsic_strokes_edges> edges_;
  gpu::Program<shaders::intrinsic_strokes_values> values_;
  StrokeMask mask_;
  gpu::BufferPtr cell_mask_, means_, residuals_, nothing_;
  bool followed_ = false;  // in this frame
};

}  // namespace inverse
