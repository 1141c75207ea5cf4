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

/// Which tiles of a frame need work: those whose input changed, and those whose solution still
/// moves (active.comp, activity.comp; docs/reference/methods/intrinsicdecomp.md, 8). Who knows what
/// changed tells so for every frame; without that, frames are worked on as a whole.
class ActiveTiles {
 public:
  ActiveTiles(const std::shared_ptr<gpu::Device>& device, Extent extent);

  uint32_t tiles() const { return lists_[0].tiles(); }
  /// Takes note of the next frame's `changed` tiles, one byte a tile, row by row, 0 where the input
  /// is that of the frame before; empty where that is not known. Returns the share of tiles that
  /// this concerns, 0…1, which is 1 where it is not known. Throws Error(internal) where there are
  /// too few or too many.
  float take(std::span<const uint8_t> changed);
  /// Records making the list of tiles whose input has changed, and of those that by now lack more
  /// than `tolerance` (rms of log shading; negative: all) of what frames would have given them.
  /// `correction` is Multigrid's, of the frame before, `hold` TemporalAnchor's.
  void record_list(gpu::Commands& commands, const gpu::BufferPtr& correction, float tolerance,
                   float hold);
  /// A vec4 a tile (activity.glsl).
  const gpu::BufferPtr& activity() const { return activity_; }
  /// Of this frame, after `record_list`; the tiles where a drawing of it differs from one of the
  /// frame before; and the list of the frame before, null where that was worked on as a whole.
  const TileList& list() const { return lists_[now_]; }
  const TileList& drawn() const { return drawn_; }
  const TileList* list_before() const { return listed_before_ ? &lists_[1 - now_] : nullptr; }
  /// Records how much the tiles have moved by this frame, from TemporalAnchor's memories of the
  /// frame `before` and of this one.
  void record_activity(gpu::Commands& commands, const gpu::BufferPtr& before,
                       const gpu::BufferPtr& now, const TileList* listed, float tolerance);
  /// The frame is recorded; `listed`: its tiles alone.
  void advance(bool listed) { listed_before_ = listed; }
  /// One word: how many tiles moved in the last frame that was watched or listed.
  const gpu::BufferPtr& busy() const { return busy_; }

 private:
  Extent extent_;
  std::array<TileList, 2> lists_;
  TileList drawn_;
  size_t now_ = 0;
  bool listed_before_ = false;
  gpu::Program<shaders::intrinsic_tiles_active> active_;
  gpu::Program<shaders::intrinsic_tiles_dilate_tiles> dilate_tiles_;
  TileProgram<shaders::intrinsic_tiles_activity> look_;
  gpu::FrameRing<gpu::BufferPtr> changed_;
  uint64_t frame_ = 0;
  gpu::BufferPtr activity_, busy_;
};

}  // namespace inverse
