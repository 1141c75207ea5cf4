// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tile_list.hpp"

#include <algorithm>
#include <bit>
#include <tuple>

namespace inverse {
namespace {

using List = shaders::image_tiles_list_tiles;

}  // namespace

TileList::TileList(const std::shared_ptr<gpu::Device>& device, Extent extent, gpu::Memory memory)
    : columns_(along(extent.width)),
      rows_(along(extent.height)),
      workgroup_(device->variant().workgroup),
      limit_(device->limits().line_groups),
      list_(device, {}, device->variant().lone_workgroup),
      merge_(device),
      flags_(gpu::Buffer::create(device, gpu::Element::word, tiles())),
      words_(gpu::Buffer::create(device, gpu::Element::word, List::LIST_TILES + tiles(), memory)) {}

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

void TileList::assign(std::span<const uint8_t> flags) const {
  auto* words = words_->map_as<uint32_t>();
  uint32_t count = 0;
  for (uint32_t i = 0; i < tiles(); ++i)
    if (flags[i]) words[List::LIST_TILES + count++] = i / columns_ << 16U | i % columns_;
  words[List::LIST_COUNT] = count;
  for (uint32_t size = 0; size < List::LIST_SIZES; ++size) {
    uint32_t* groups = words + List::LIST_ARGUMENTS + 3 * size;
    std::tie(groups[0], groups[1]) =
        gpu::rows_of_groups(((count << size) + workgroup_ - 1) / workgroup_, limit_);
    groups[2] = 1;
  }
}

uint64_t TileList::arguments(uint32_t items_a_tile) {
  return sizeof(uint32_t) *
         (List::LIST_ARGUMENTS + 3ULL * static_cast<uint32_t>(std::countr_zero(items_a_tile)));
}

std::vector<uint8_t> dilate_tiles(std::span<const uint8_t> flags, uint32_t columns) {
  const auto rows = static_cast<uint32_t>(flags.size() / columns);
  std::vector<uint8_t> spread(flags.size());
  for (uint32_t y = 0; y < rows; ++y)
    for (uint32_t x = 0; x < columns; ++x) {
      if (!flags[size_t{y} * columns + x]) continue;
      for (uint32_t v = y > 0 ? y - 1 : 0; v <= std::min(y + 1, rows - 1); ++v)
        for (uint32_t u = x > 0 ? x - 1 : 0; u <= std::min(x + 1, columns - 1); ++u)
          spread[size_t{v} * columns + u] = 1;
    }
  return spread;
}

}  // namespace inverse
