// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/camera/known_reflectance.hpp"
#include "kernels/image/tiles/tile_list.hpp"
#include "kernels/intrinsic/guide/guide.hpp"
#include "kernels/intrinsic_depth_edges.spv.hpp"
#include "kernels/intrinsic_depth_surfaces.spv.hpp"

namespace inverse {

/// Changes what a prior has written by the surfaces that a frame shows: shading is more even on a
/// flat surface, and less where its normal turns (docs/reference/methods/intrinsicdecomp.md, 16).
class DepthCue {
 public:
  DepthCue(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// The surfaces of the frame that is recorded next, which stay until then; null, or without
  /// `surface`: none are known. `continues`: the frame before was recorded here, too.
  void set(const KnownReflectance* known, bool continues);
  bool empty() const { return !known_; }
  /// Whether surfaces are known now and were not in the frame before, or the other way round.
  bool changed() const { return changed_; }
  /// A word: 0 if the surfaces are those of the frame before. Of a cue that is not empty.
  const gpu::BufferPtr& outdated() const { return known_->outdated; }

  /// Records the change of edges that the prior has just written: those of listed tiles, or all.
  /// Buffers as in EdgePrior::Target. `weight` 0: nothing changes.
  void record_edges(gpu::Commands& commands, const Guide& guide, const gpu::BufferPtr& system,
                    const gpu::BufferPtr& flux, const TileList* listed, float weight);

 private:
  /// Records the factors of the surfaces, unless those of the frame before still hold.
  void record_surfaces(gpu::Commands& commands);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  gpu::Program<shaders::intrinsic_depth_surfaces> surfaces_;
  TileProgram<shaders::intrinsic_depth_edges> edges_;
  gpu::BufferPtr factors_;  // of the edges of known_, two a pixel
  const KnownReflectance* known_ = nullptr;
  bool changed_ = false;
  bool recorded_ = false, recorded_before_ = false;  // the factors of this frame, and of the last
};

}  // namespace inverse
