// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/image_tiles_list_tiles.spv.hpp"
#include "kernels/image_tiles_merge_tiles.spv.hpp"

namespace inverse {

/// Tiles of 16 x 16 pixels to which work on a frame is limited: a list (tiles.glsl) with workgroup
/// counts for indirect dispatch. Made on the device from flags.
class TileList {
 public:
  static constexpr uint32_t kTile = 16;  ///< pixels along a tile
  /// Number of tiles along `pixels`, and of a whole frame.
  static constexpr uint32_t along(uint32_t pixels) { return (pixels + kTile - 1) / kTile; }
  static constexpr uint32_t count(Extent extent) {
    return along(extent.width) * along(extent.height);
  }
  TileList(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Number of tiles of a frame.
  uint32_t tiles() const { return columns_ * rows_; }
  /// One word per tile, row by row: 1 to list it, else 0. Written by a kernel of the caller.
  const gpu::BufferPtr& flags() const { return flags_; }
  /// Records flagging also the tiles that `others` flags, and those beside them; null: none.
  void record_merge(gpu::Commands& commands, const gpu::BufferPtr& others) const;
  /// Records building the list from the flags.
  void record(gpu::Commands& commands) const;
  /// The list; its first word is the number of tiles.
  const gpu::BufferPtr& words() const { return words_; }
  /// Byte offset in `words` of the workgroup counts for kernels with this number of invocations per
  /// tile (a power of two up to 64).
  static uint64_t arguments(uint32_t items_a_tile);

 private:
  uint32_t columns_, rows_, workgroup_, limit_;
  gpu::Program<shaders::image_tiles_list_tiles> list_;
  gpu::Program<shaders::image_tiles_merge_tiles> merge_;
  gpu::BufferPtr flags_, words_;
};

/// A kernel that runs over a whole frame or over a list of tiles, each with `across` x `down`
/// invocations.
template <typename Shader>
class TileProgram {
 public:
  TileProgram(const std::shared_ptr<gpu::Device>& device, typename Shader::Constants constants,
              uint32_t across, uint32_t down)
      : whole_(device, constants),
        items_(across * down),
        nothing_(gpu::Buffer::create(device, gpu::Element::word, 1)) {
    constants.tile_across = across;
    constants.tile_down = down;
    listed_ = {device, constants};
  }

  /// Records it over the tiles of `listed`, or over `whole` if that is null.
  template <typename Push = typename Shader::Push>
  void dispatch(gpu::Commands& commands, const TileList* listed, typename Shader::Buffers buffers,
                const Push& push, gpu::Items whole) const {
    buffers.list = listed ? listed->words() : nothing_;
    if (listed)
      commands.dispatch_indirect(listed_, buffers, push, listed->words(),
                                 TileList::arguments(items_));
    else
      commands.dispatch(whole_, buffers, push, whole);
  }

 private:
  gpu::Program<Shader> whole_, listed_;
  uint32_t items_ = 0;      // invocations per tile
  gpu::BufferPtr nothing_;  // in the list's place
};

}  // namespace inverse
