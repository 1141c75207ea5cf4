// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/intrinsic/guide/guide.hpp"
#include "kernels/intrinsic_temporal_cut_decision.spv.hpp"
#include "kernels/intrinsic_temporal_mismatch.spv.hpp"
#include "kernels/intrinsic_temporal_static_tiles.spv.hpp"

namespace inverse {

/// The history of a frame for the next one, and how well both match (temporal.glsl;
/// docs/reference/methods/intrinsicdecomp.md, 6). Cuts are detected on the device, so that nothing
/// waits for the host.
class TemporalAnchor {
 public:
  struct Params {
    /// Weight of the previous frame's reflectance if only light changes, per pixel, 0…1e3; 0 turns
    /// the anchor and `hold` off.
    float anchor_weight = 1.2F;
    /// Frames after a reset or cut until the weight is full, 1…1e3: a first frame is no more
    /// certain than others.
    float anchor_frames = 7.0F;
    /// Change of chroma that halves it, natural log units, 1e-3…10; it counts less in the dark.
    float anchor_chroma = 0.5F;
    /// Change of local log contrast that halves it, 1e-3…10.
    float anchor_detail = 4.0F;
    /// Deviation of the change of log intensity inside a cell that halves it, 1e-3…10.
    float anchor_texture = 2.0F;
    /// Share of the structure around, 0.01…100, that halves it when it moves: edges of shadows come
    /// and go, but paint stays in place unless content moves.
    float anchor_motion = 0.4F;
    /// Share of the previous frame's reflectance that is kept, 0…0.99, if neither content nor light
    /// changes: it averages sensor noise.
    float hold = 0.8F;
    /// Change of a cell's log intensity that halves that, 1e-3…10.
    float hold_light = 0.02F;
    /// Difference between a pixel's change of log intensity and its cell's that halves that,
    /// 1e-3…10.
    float hold_texture = 0.2F;
    /// Mean mismatch of a frame, 0…1, from which on it is a cut. A sixth of it is enough if the
    /// frames before had an eighth of that.
    float cut_fraction = 0.3F;
    bool operator==(const Params&) const = default;
  };
  static constexpr uint64_t kMemoryStride =
      shaders::intrinsic_temporal_mismatch::MEMORY_STRIDE;  ///< vec4 a pack of pixels
  static constexpr uint64_t kStartStride =
      shaders::intrinsic_temporal_mismatch::START_STRIDE;  ///< vec4 a pack of cells

  TemporalAnchor(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Records the mismatch of the frame of `guide` with the frame before; needs `kept` and `memory`
  /// of that. `continues`: that frame had a frame before, too.
  void record(gpu::Commands& commands, const Guide& guide, const Params& params, bool continues);
  const gpu::BufferPtr& kept() const {
    return kept_;
  }  ///< vec4 a cell: d, c0, c1, m'; layers.comp writes it
  const gpu::BufferPtr& memory() const {
    return memory_;
  }  ///< of packs of pixels: m and the brightness of reflectance
  const gpu::BufferPtr& now() const {
    return now_;
  }  ///< the same of the frame at work: assemble.comp writes its m, layers.comp all
  /// Ends a frame: its history is that of the next one.
  void advance() { memory_.swap(now_); }
  const gpu::BufferPtr& mismatch() const { return mismatch_; }  ///< vec4 a cell (mismatch.comp)
  const gpu::BufferPtr& tiles() const {
    return tiles_;
  }  ///< vec4 a tile of 4 x 4 cells (static_tiles.comp)
  const gpu::BufferPtr& cut_decision() const {
    return cut_decision_;
  }  ///< one vec4 (temporal.glsl)

 private:
  Extent extent_, cells_;
  gpu::Program<shaders::intrinsic_temporal_mismatch> compare_;
  gpu::Program<shaders::intrinsic_temporal_static_tiles> static_tiles_;
  gpu::Program<shaders::intrinsic_temporal_cut_decision> decide_;
  gpu::BufferPtr kept_, memory_, now_, mismatch_, tiles_, sums_, cut_decision_;
  bool cleared_ = false;
};

}  // namespace inverse
