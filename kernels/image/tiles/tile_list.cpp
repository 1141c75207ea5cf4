// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tile_list.hpp"

#include <bit>

namespace inverse {
namespace {

using List = shaders::image_tiles_list_tiles;

}  // namespace

TileList::TileList(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : columns_(along(extent.width)),
      rows_(along(extent.height)),
      workgroup_(device->variant().workgroup),
      limit_(device->limits().line_groups),
      list_(device, {}, device->variant().lone_workgroup),
      merge_(device),
      flags_(gpu::Buffer::create(device, gpu::Element::word, tiles())),
      words_(gpu::Buffer::create(device, gpu::Element::word, List::LIST_TILES + tiles())) {}

void TileList::record_merge(gpu::Commands& commands, const gpu::BufferPtr& others) const {
  if (!others) return;
  commands.dispatch(merge_, {.others = others, .flags = flags_}, {.tiles = {columns_, rows_}},
                    {tiles()});
}

void TileList::record(gpu::Commands& commands) const {
  commands.dispatch(
      list_, {.flags = flags_, .list = words_},
      {.tiles = tiles(), .columns = columns_, .workgroup = workgroup_, .limit = limit_}, {});
}

uint64_t TileList::arguments(uint32_t items_a_tile) {
  return sizeof(uint32_t) *
         (List::LIST_ARGUMENTS + 3ULL * static_cast<uint32_t>(std::countr_zero(items_a_tile)));
}

}  // namespace inverse
