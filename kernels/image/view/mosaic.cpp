// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mosaic.hpp"

#include "common/error.hpp"
#include "kernels/image/pyramid.hpp"

namespace inverse {

Mosaic::Mosaic(const std::shared_ptr<gpu::Device>& device) : kernel_(device) {}

void Mosaic::record(gpu::Commands& commands, const std::array<Tile, 4>& tiles,
                    const Plane& target) const {
  const Extent size = target.extent, large = half_of(size);
  const Plane* any = nullptr;
  for (const Tile& tile : tiles) {
    if (!tile.picture) continue;
    if (tile.picture->extent != size)
      throw Error(ErrorKind::internal, "a mosaic's planes differ in size");
    any = tile.picture;
  }
  if (!any) throw Error(ErrorKind::internal, "a mosaic of nothing");
  for (uint32_t i = 0; i < 4; ++i) {
    const bool right = i % 2 == 1, bottom = i / 2 == 1;
    const Extent tile{right ? size.width - large.width : large.width,
                      bottom ? size.height - large.height : large.height};
    if (tile.pixels() == 0) continue;  // a frame one pixel wide or high
    const Plane& picture = tiles[i].picture ? *tiles[i].picture : *any;
    const uint32_t top = bottom ? large.height : 0;
    commands.dispatch_rows(
        kernel_, {.picture = picture.buffer, .target = gpu::by_rows(target.buffer)},
        {.size = size,
         .origin = {right ? large.width : 0, top},
         .tile = tile,
         .shading = tiles[i].source == Drawing::Source::shading,
         .gain = tiles[i].picture ? tiles[i].gain : 0,
         .first_row = 0},
        {.width = tile.width, .rows = size.height, .begin = top, .end = top + tile.height});
  }
}

std::pair<int, int> Mosaic::shown_at(int x, int y, Extent target) {
  const int width = static_cast<int>(target.width), height = static_cast<int>(target.height);
  if (x < 0 || y < 0 || x >= width || y >= height) return {x, y};
  const Extent large = half_of(target);
  const auto in_tile = [](int at, uint32_t first) {
    return 2 * (at < static_cast<int>(first) ? at : at - static_cast<int>(first));
  };
  return {in_tile(x, large.width), in_tile(y, large.height)};
}

}  // namespace inverse
