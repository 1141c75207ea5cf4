// SPDX-License-Identifier: LGPL-2.1-or-later
#include "active_tiles.hpp"

#include <algorithm>
#include <string>

#include "common/error.hpp"
#include "kernels/image/pyramid.hpp"

namespace inverse {

ActiveTiles::ActiveTiles(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : extent_(extent),
      lists_{TileList(device, extent), TileList(device, extent)},
      around_{TileList(device, extent), TileList(device, extent)},
      drawn_(device, extent),
      active_(device),
      dilate_(device),
      measure_activity_(device, {}, 1, 1),
      activity_(gpu::Buffer::create(device, gpu::Element::vec4, tiles())),
      moving_(gpu::Buffer::create(device, gpu::Element::word, 1)) {
  for (auto& changed : changed_)
    changed = gpu::Buffer::create(device, gpu::Element::word, tiles(), gpu::Memory::upload);
}

float ActiveTiles::take(std::span<const uint8_t> changed) {
  if (changed.empty()) return 1;
  if (changed.size() != tiles())
    throw Error(ErrorKind::internal, "got " + std::to_string(changed.size()) +
                                         " tiles for a frame of " + std::to_string(tiles()));
  ++frame_;
  std::copy(changed.begin(), changed.end(), changed_[frame_]->map_as<uint32_t>());
  const auto affected = dilate_tiles(changed, lists_[0].columns());
  return static_cast<float>(std::count(affected.begin(), affected.end(), 1)) /
         static_cast<float>(tiles());
}

void ActiveTiles::record_list(gpu::Commands& commands, const gpu::BufferPtr& correction,
                              float tolerance, float hold, const gpu::BufferPtr& others) {
  now_ = 1 - now_;
  const TileList& list = lists_[now_];
  const Extent cells = half_of(half_of(extent_));
  commands.dispatch(active_,
                    {.changed = changed_[frame_],
                     .correction = correction,
                     .activity = activity_,
                     .flags = list.flags()},
                    {.tiles = {list.columns(), list.rows()},
                     .cell_packs = {pack4_count(cells.width), cells.height},
                     .tolerance = tolerance,
                     .hold = hold},
                    line_of(tiles()));
  list.record_merge(commands, others);
  list.record(commands);
  commands.dispatch(
      dilate_, {.flags = list.flags(), .around = around_[now_].flags(), .drawn = drawn_.flags()},
      {.tiles = {list.columns(), list.rows()}}, line_of(tiles()));
  around_[now_].record(commands);
  drawn_.record(commands);
}

void ActiveTiles::record_activity(gpu::Commands& commands, const gpu::BufferPtr& before,
                                  const gpu::BufferPtr& now, const TileList* listed,
                                  float tolerance) {
  commands.fill(moving_);
  measure_activity_.dispatch(commands, listed,
                             {.changed = changed_[frame_],
                              .before = before,
                              .now = now,
                              .activity = activity_,
                              .moving = moving_},
                             {.tiles = {lists_[0].columns(), lists_[0].rows()},
                              .packs = {pack4_count(extent_.width), extent_.height},
                              .size = extent_,
                              .tolerance = tolerance},
                             line_of(tiles()));
}

}  // namespace inverse
