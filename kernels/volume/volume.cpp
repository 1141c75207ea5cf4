// SPDX-License-Identifier: LGPL-2.1-or-later
#include "volume.hpp"

#include <bit>
#include <limits>
#include <numeric>
#include <vector>

namespace inverse {
namespace {

using shaders::volume_allocate;

constexpr uint32_t kNoBlock = 0xffffffff;
constexpr uint32_t kColumns = 64;       // of a block, an invocation each
constexpr uint32_t kEntriesABlock = 4;  // of the hash table, at least two
constexpr uint32_t kAllocateStep = 2;   // pixels

}  // namespace

Volume::View::View(const std::shared_ptr<gpu::Device>& device, Extent size)
    : extent(size),
      depth(gpu::Buffer::create(device, gpu::Element::scalar, size.pixels())),
      surface(gpu::Buffer::create(device, gpu::Element::vec4, size.pixels())),
      reflectance(gpu::Buffer::create(device, gpu::Element::vec4, size.pixels())),
      strokes(gpu::Buffer::create(device, gpu::Element::word, size.pixels())),
      nearest(gpu::Buffer::create(device, gpu::Element::word, tiles().pixels())),
      farthest(gpu::Buffer::create(device, gpu::Element::word, tiles().pixels())) {}

Volume::Volume(const std::shared_ptr<gpu::Device>& device, const Params& params)
    : params_(params),
      entries_(std::bit_ceil(kEntriesABlock * params.blocks) / 2),
      allocate_(device),
      list_blocks_(device),
      integrate_(device, {}, kColumns),
      ranges_(device),
      march_(device),
      normals_(device),
      table_(gpu::Buffer::create(device, gpu::Element::word, 2ULL * entries_)),
      keys_(gpu::Buffer::create(device, gpu::Element::word, params.blocks)),
      fresh_(gpu::Buffer::create(device, gpu::Element::word, params.blocks)),
      list_(gpu::Buffer::create(device, gpu::Element::word, params.blocks)),
      colored_(gpu::Buffer::create(device, gpu::Element::word, params.blocks)),
      voxels_(gpu::Buffer::create(device, gpu::Element::word,
                                  uint64_t{params.blocks} * volume_allocate::kBlockVoxels)),
      colors_(gpu::Buffer::create(device, gpu::Element::word,
                                  uint64_t{params.blocks} * 2 * volume_allocate::kBlockVoxels)) {
  std::vector<uint32_t> places(params.blocks), start(volume_allocate::kStateWords);
  std::iota(places.rbegin(), places.rend(), 0U);
  start[1] = start[2] = 1;
  start[volume_allocate::kFree] = params.blocks;
  free_ = gpu::make_table(device, gpu::Element::word, places);
  start_ = gpu::make_table(device, gpu::Element::word, start);
  state_ = gpu::Buffer::create(device, gpu::Element::word, start.size());
  gpu::Commands commands(device);
  commands.begin();
  record_clear(commands);
  commands.submit();
  commands.wait();
}

void Volume::record_clear(gpu::Commands& commands) {
  commands.fill(table_, kNoBlock);
  commands.fill(keys_, kNoBlock);
  commands.fill(fresh_);
  commands.fill(colored_);
  commands.copy(start_, state_, state_->bytes());
}

void Volume::record_list(gpu::Commands& commands, const Lens& lens, Extent extent,
                         const gpu::BufferPtr& pose) {
  commands.copy(start_, state_, 3 * sizeof(uint32_t));
  commands.dispatch(list_blocks_,
                    {.keys = keys_, .pose = pose, .fresh = fresh_, .state = state_, .list = list_},
                    {.lens = lens.values(),
                     .size = extent,
                     .blocks = params_.blocks,
                     .voxel = params_.voxel,
                     .max_depth = params_.max_depth},
                    params_.blocks);
}

void Volume::record_integrate(gpu::Commands& commands, const Frame& frame,
                              const gpu::BufferPtr& layers, Added added) {
  const float truncation = params_.truncation * params_.voxel;
  // The counts of this frame; they stand beside each other.
  constexpr uint64_t kFrom = volume_allocate::kRefused * sizeof(uint32_t),
                     kTo = (volume_allocate::kMade + 1) * sizeof(uint32_t);
  commands.copy(start_, state_, kTo - kFrom, kFrom, kFrom);
  if (added.geometry) {
    const Extent across{(frame.extent.width + kAllocateStep - 1) / kAllocateStep,
                        (frame.extent.height + kAllocateStep - 1) / kAllocateStep};
    commands.dispatch(allocate_,
                      {.depth = frame.depth,
                       .pose = frame.pose,
                       .free_blocks = free_,
                       .table = table_,
                       .keys = keys_,
                       .fresh = fresh_,
                       .state = state_},
                      {.lens = frame.lens.values(),
                       .size = frame.extent,
                       .step = kAllocateStep,
                       .table_mask = entries_ - 1,
                       .voxel = params_.voxel,
                       .truncation = truncation,
                       .max_depth = params_.max_depth},
                      static_cast<uint32_t>(across.pixels()));
  }
  record_list(commands, frame.lens, frame.extent, frame.pose);
  commands.dispatch_indirect(integrate_,
                             {.list = list_,
                              .keys = keys_,
                              .pose = frame.pose,
                              .surface = frame.surface,
                              .depth = frame.depth,
                              .layers = layers,
                              .voxels = voxels_,
                              .colors = colors_,
                              .colored = colored_},
                             {.lens = frame.lens.values(),
                              .size = frame.extent,
                              .voxel = params_.voxel,
                              .truncation = truncation,
                              .max_depth = params_.max_depth,
                              .memory = params_.memory,
                              .geometry = uint32_t{added.geometry},
                              .reflectance = uint32_t{added.reflectance}},
                             state_);
}

void Volume::record_march(gpu::Commands& commands, const Lens& lens, const gpu::BufferPtr& pose,
                          const View& view) {
  record_list(commands, lens, view.extent, pose);
  commands.fill(view.nearest, std::bit_cast<uint32_t>(std::numeric_limits<float>::max()));
  commands.fill(view.farthest);
  const Extent tiles = view.tiles();
  commands.dispatch(ranges_,
                    {.list = list_,
                     .state = state_,
                     .keys = keys_,
                     .pose = pose,
                     .nearest = view.nearest,
                     .farthest = view.farthest},
                    {.lens = lens.values(),
                     .tiles = tiles,
                     .voxel = params_.voxel,
                     .min_depth = params_.min_depth},
                    params_.blocks);
  commands.dispatch(march_,
                    {.table = table_,
                     .voxels = voxels_,
                     .colors = colors_,
                     .nearest = view.nearest,
                     .farthest = view.farthest,
                     .pose = pose,
                     .depth = view.depth,
                     .reflectance = view.reflectance,
                     .strokes = view.strokes},
                    {.lens = lens.values(),
                     .size = view.extent,
                     .tiles = tiles.width,
                     .table_mask = entries_ - 1,
                     .voxel = params_.voxel,
                     .truncation = params_.truncation * params_.voxel},
                    static_cast<uint32_t>(view.extent.pixels()));
  commands.dispatch(normals_, {.depth = view.depth, .surface = view.surface},
                    {.lens = lens.values(), .size = view.extent},
                    static_cast<uint32_t>(view.extent.pixels()));
}

}  // namespace inverse
