// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <memory>
#include <span>

#include "kernels/image/pack4.hpp"
#include "kernels/image/tiles/tile_list.hpp"
#include "kernels/intrinsic_tiles_active.spv.hpp"
#include "kernels/intrinsic_tiles_activity.spv.hpp"
#include "kernels/intrinsic_tiles_dilate_tiles.spv.hpp"

namespace inverse {

/// The tiles of a frame that need work: those whose input changed, and those whose solution has not
/// converged (active.comp, activity.comp; docs/reference/methods/intrinsicdecomp.md, 10). Without
/// knowledge of changed tiles, frames are worked on as a whole.
class ActiveTiles {
 public:
  ActiveTiles(const std::shared_ptr<gpu::Device>& device, Extent extent);

  uint32_t tiles() const { return lists_[0].tiles(); }
  /// Sets the `changed` tiles of the next frame, one byte a tile, row by row, 0 if its input is
  /// that of the frame before; empty if that is not known. Returns the share of tiles that changed
  /// or are beside such, 0…1; 1 if it is not known. Throws Error(internal) if the number is wrong.
  float take(std::span<const uint8_t> changed);
  /// Records the list of tiles whose input has changed, or whose estimated error exceeds
  /// `tolerance` (rms log shading; negative: all tiles). `correction` is Multigrid's, of the frame
  /// before, `hold` TemporalAnchor's. Also those that `others`, a word a
  /// tile, flags, and those beside them; null: none.
  void record_list(gpu::Commands& commands, const gpu::BufferPtr& correction, float tolerance,
                   float hold, const gpu::BufferPtr& others = nullptr);
  /// A vec4 a tile (activity.glsl).
  const gpu::BufferPtr& activity() const { return activity_; }
  /// After `record_list`: the tiles of this frame; these and all beside them; those where a drawing
  /// of it differs from one of the frame before; and `around` of the frame before, null if that was
  /// worked on as a whole.
  const TileList& list() const { return lists_[now_]; }
  const TileList& around() const { return around_[now_]; }
  const TileList& drawn() const { return drawn_; }
  const TileList* around_before() const { return listed_before_ ? &around_[1 - now_] : nullptr; }
  /// Records how much the tiles have moved by this frame, from TemporalAnchor's memories of the
  /// frame `before` and of this one.
  void record_activity(gpu::Commands& commands, const gpu::BufferPtr& before,
                       const gpu::BufferPtr& now, const TileList* listed, float tolerance);
  /// Ends a frame; `listed`: it worked on its tiles only.
  void advance(bool listed) { listed_before_ = listed; }
  /// One word: number of tiles that moved in the last frame of Plan::Mode::watched or tiles.
  const gpu::BufferPtr& moving() const { return moving_; }

 private:
  Extent extent_;
  std::array<TileList, 2> lists_, around_;
  TileList drawn_;
  size_t now_ = 0;
  bool listed_before_ = false;
  gpu::Program<shaders::intrinsic_tiles_active> active_;
  gpu::Program<shaders::intrinsic_tiles_dilate_tiles> dilate_;
  TileProgram<shaders::intrinsic_tiles_activity> measure_activity_;
  gpu::FrameRing<gpu::BufferPtr> changed_;
  uint64_t frame_ = 0;
  gpu::BufferPtr activity_, moving_;
};

}  // namespace inverse
