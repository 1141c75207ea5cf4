// SPDX-License-Identifier: LGPL-2.1-or-later
#include "changed_tiles.hpp"

#include <algorithm>
#include <cstring>

#include "kernels/image/tiles/tile_list.hpp"

namespace inverse {
namespace {
constexpr uint32_t kTile = TileList::kTile;
}  // namespace

ChangedTiles::ChangedTiles(PixelFormat format, Extent extent)
    : format_(format), extent_(extent), changed_(TileList::count(extent)) {
  size_t bytes = 0;
  for (uint32_t plane = 0; plane < plane_count(format); ++plane)
    bytes += size_t{row_bytes(format, extent, plane)} * plane_rows(format, extent, plane);
  before_.resize(bytes);
}

std::span<const uint8_t> ChangedTiles::next(std::span<const Rows> planes) {
  const bool compare = known_;
  known_ = true;
  std::fill(changed_.begin(), changed_.end(), uint8_t{0});
  uint8_t* before = before_.data();
  for (uint32_t plane = 0; plane < planes.size(); ++plane) {
    const size_t bytes = row_bytes(format_, extent_, plane);
    const size_t tile_bytes = row_bytes(format_, {kTile, kTile}, plane);
    const uint32_t rows = plane_rows(format_, extent_, plane);
    const uint32_t tile_rows = plane_rows(format_, {kTile, kTile}, plane);
    for (uint32_t row = 0; row < rows; ++row, before += bytes) {
      const uint8_t* now = planes[plane].data + static_cast<ptrdiff_t>(row) * planes[plane].stride;
      if (compare && memcmp(before, now, bytes) == 0) continue;
      uint8_t* changed = &changed_[size_t{row / tile_rows} * TileList::along(extent_.width)];
      if (compare)
        for (size_t at = 0; at < bytes; at += tile_bytes, ++changed)
          if (!*changed)
            *changed = memcmp(before + at, now + at, std::min(tile_bytes, bytes - at)) != 0;
      memcpy(before, now, bytes);
    }
  }
  return compare ? std::span<const uint8_t>(changed_) : std::span<const uint8_t>();
}

}  // namespace inverse
