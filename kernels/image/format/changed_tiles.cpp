// SPDX-License-Identifier: LGPL-2.1-or-later
#include "changed_tiles.hpp"

#include <algorithm>
#include <cstring>

#include "kernels/image/tiles/tile_list.hpp"

namespace inverse {
namespace {
constexpr uint32_t kTile = TileList::kTile;
constexpr uint32_t kMoving = 4;  // frames running of which most tiles change
}  // namespace

ChangedTiles::ChangedTiles(PixelFormat format, Extent extent)
    : format_(format), extent_(extent), changed_(TileList::count(extent)) {
  for (uint32_t plane = 0; plane < format.planes; ++plane)
    bytes_ += size_t{row_bytes(format, extent, plane)} * plane_rows(format, extent, plane);
}

std::span<const uint8_t> ChangedTiles::next(std::span<const Rows> planes) {
  const bool compare = known_;
  known_ = true;
  before_.resize(bytes_);
  if (compare && moving_ >= kMoving && moves(planes)) return {};
  const bool stopped = moving_ >= kMoving;  // whose frame before is not known as a whole
  std::fill(changed_.begin(), changed_.end(), uint8_t{0});
  find_changed(planes, 1, compare);
  moving_ = !stopped && over_half_changed() ? moving_ + 1 : 0;
  if (!compare || stopped) return {};
  return changed_;
}

bool ChangedTiles::moves(std::span<const Rows> planes) {
  std::fill(changed_.begin(), changed_.end(), uint8_t{0});
  find_changed(planes, kTile, true);
  return over_half_changed();
}

bool ChangedTiles::over_half_changed() const {
  const auto count = std::count(changed_.begin(), changed_.end(), uint8_t{1});
  return 2 * static_cast<size_t>(count) > changed_.size();
}

void ChangedTiles::find_changed(std::span<const Rows> planes, uint32_t step, bool compare) {
  // Tiles whose bytes begin and end a word: of ten-bit thirds, three have 16 words.
  const uint32_t group = format_.unit == Unit::thirds ? 3 : 1;
  const size_t across = TileList::along(extent_.width);
  uint8_t* of_plane = before_.data();
  for (uint32_t plane = 0; plane < planes.size(); ++plane) {
    const size_t bytes = row_bytes(format_, extent_, plane);
    const size_t group_bytes = row_bytes(format_, {group * kTile, kTile}, plane);
    const uint32_t rows = plane_rows(format_, extent_, plane);
    const uint32_t tile_rows = plane_rows(format_, {kTile, kTile}, plane);
    for (uint32_t row = 0; row < rows; row += step) {
      uint8_t* before = of_plane + row * bytes;
      const uint8_t* now = planes[plane].data + static_cast<ptrdiff_t>(row) * planes[plane].stride;
      if (compare && memcmp(before, now, bytes) == 0) continue;
      uint8_t* changed = &changed_[row / tile_rows * across];
      if (compare)
        for (size_t at = 0, tile = 0; tile < across; at += group_bytes, tile += group)
          if (!changed[tile] &&
              memcmp(before + at, now + at, std::min(group_bytes, bytes - at)) != 0)
            std::fill_n(changed + tile, std::min<size_t>(group, across - tile), uint8_t{1});
      memcpy(before, now, bytes);
    }
    of_plane += rows * bytes;
  }
}

}  // namespace inverse
