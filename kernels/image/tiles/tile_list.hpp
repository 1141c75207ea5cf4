#pragma once
#include <memory>
#include <span>
#include <vector>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/image_tiles_list_tiles.spv.hpp"

namespace inverse {

/// Tiles of 16 x 16 pixels to which work on a frame is limited: a list (tiles.glsl), with the
/// numbers of workgroups for kernels that run over it. It is made on the device from flags, or on
/// the host.
class TileList {
 public:
  static constexpr uint32_t kTile = 16;  ///< pixels along a tile
  /// Tiles along so many pixels, and of a whole frame.
  static constexpr uint32_t along(uint32_t pixels) { return (pixels + kTile - 1) / kTile; }
  static constexpr uint32_t count(Extent extent) {
    return along(extent.width) * along(extent.height);
  }
  /// Memory::upload for a list that is made on the host.
  TileList(const std::shared_ptr<gpu::Device>& device, Extent extent,
           gpu::Memory memory = gpu::Memory::device);

  /// How many tiles a frame has, and along its width.
  uint32_t tiles() const { return columns_ * rows_; }
  uint32_t columns() const { return columns_; }
  uint32_t rows() const { return rows_; }
  /// One word a tile, row by row: 1 where it is to be listed, else 0. Somebody's kernel fills it.
  const gpu::BufferPtr& flags() const { return flags_; }
  /// Records making the list from the flags.
  void record(gpu::Commands& commands) const;
  /// Makes the list on the host: the tiles where `flags`, row by row, is not 0. No work with the
  /// list may be in flight.
  void assign(std::span<const uint8_t> flags) const;
  /// The list; its first word is how many tiles it has.
  const gpu::BufferPtr& words() const { return words_; }
  /// Where in `words` the workgroups of a kernel with so many invocations a tile (a power of two up
  /// to 64) are, in bytes.
  static uint64_t arguments(uint32_t items_a_tile);

 private:
  uint32_t columns_, rows_, workgroup_;
  gpu::Program<shaders::image_tiles_list_tiles> list_;
  gpu::BufferPtr flags_, words_;
};

/// Those tiles, row by row, `columns` a row, that are flagged or beside (also diagonally) one that
/// is.
std::vector<uint8_t> spread_tiles(std::span<const uint8_t> flags, uint32_t columns);

/// A kernel that runs over a whole frame or over the tiles of a list, which it gets here. A tile
/// has `across` x `down` invocations; 0 where it only runs over whole frames.
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

  /// Records it over the tiles of `listed`, or over `whole` where that is null.
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
  const gpu::KernelPtr& whole() const { return whole_.kernel(); }

 private:
  gpu::Program<Shader> whole_, listed_;
  uint32_t items_ = 0;      // invocations a tile
  gpu::BufferPtr nothing_;  // in the list's place
};

}  // namespace inverse
