// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/image_tiles_list_tiles.spv.hpp"
#include "kernels/image_tiles_merge_tiles.spv.hpp"

namespace inverse {

/// Tiles of 16 x 16 pixels to which work on a frame is limited: a list (tiles.glsl) with workgroup
/// counts for indirect dispatch. Made on the device from flags, or on the host.
class TileList {
 public:
  static constexpr uint32_t kTile = 16;  ///< pixels along a tile
  /// Number of tiles along `pixels`, and of a whole frame.
  static constexpr uint32_t along(uint32_t pixels) { return (pixels + kTile - 1) / kTile; }
  static constexpr uint32_t count(Extent extent) {
    return along(extent.width) * along(extent.height);
  }
  /// Memory::upload for a list made on the host.
  TileList(const std::shared_ptr<gpu::Device>& device, Extent extent,
           gpu::Memory memory = gpu::Memory::device);

  /// Number of tiles of a frame, and along its width.
  uint32_t tiles() const { return columns_ * rows_; }
  uint32_t columns() const { return columns_; }
  uint32_t rows() const { return rows_; }
  /// One word per tile, row by row: 1 to list it, else 0. Written by a kernel of the caller.
  const gpu::BufferPtr& flags() const { return flags_; }
  /// Records flagging also the tiles that `others` flags, and those beside them; null: none.
  void record_merge(gpu::Commands& commands, const gpu::BufferPtr& others) const;
  /// Records building the list from the flags.
  void record(gpu::Commands& commands) const;
  /// Builds the list on the host from the tiles whose `flags`, row by row, are not 0. No submitted
  /// work may use the list meanwhile.
  void assign(std::span<const uint8_t> flags) const;
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

/// Dilates flags by one tile, also diagonally; `columns` tiles per row.
std::vector<uint8_t> dilate_tiles(std::span<const uint8_t> flags, uint32_t columns);

/// A kernel that runs over a whole frame or over a list of tiles. A tile has `across` x `down`
/// invocations; 0 if it only runs over whole frames.
template <typename Shader>
class TileProgram {
 public:
  TileProgram() = default;
  TileProgram(const std::shared_ptr<gpu::Device>& device, typename Shader::Constants constants,
              uint32_t across, uint32_t down)
      : whole_(device, constants),
        items_(across * down),
        nothing_(gpu::Buffer::create(device, gpu::Element::word, 1)) {
    if (items_ == 0) return;
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
  /// As `dispatch`; a whole frame as by Commands::dispatch_rows.
  template <typename Push = typename Shader::Push>
  void dispatch_rows(gpu::Commands& commands, const TileList* listed,
                     typename Shader::Buffers buffers, const Push& push,
                     const gpu::Rows& whole) const {
    if (listed) return dispatch(commands, listed, buffers, push, {});
    buffers.list = nothing_;
    commands.dispatch_rows(whole_, buffers, push, whole);
  }
  const gpu::KernelPtr& whole() const { return whole_.kernel(); }

 private:
  gpu::Program<Shader> whole_, listed_;
  uint32_t items_ = 0;      // invocations per tile
  gpu::BufferPtr nothing_;  // in the list's place
};

}  // namespace inverse
