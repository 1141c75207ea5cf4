// SPDX-License-Identifier: LGPL-2.1-or-later
#include "volume.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace inverse {
namespace {

using shaders::depth_allocate;

constexpr uint32_t kNoBlock = VolumeData::kNoBlock;
constexpr uint32_t kColumns = 64;       // of a block, an invocation each
constexpr uint32_t kEntriesABlock = 4;  // of the hash table, at least two
constexpr uint32_t kAllocateStep = 2;   // pixels

/// As in blocks.glsl.
uint32_t hash_of(uint32_t key) {
  key = (key ^ key >> 16) * 0x85ebca6bU;
  key = (key ^ key >> 13) * 0xc2b2ae35U;
  return key ^ key >> 16;
}

}  // namespace

Volume::View::View(const std::shared_ptr<gpu::Device>& device, Extent size)
    : extent(size),
      depth(gpu::Buffer::create(device, gpu::Element::scalar, size.pixels())),
      surface(gpu::Buffer::create(device, gpu::Element::vec4, size.pixels())),
      reflectance(gpu::Buffer::create(device, gpu::Element::vec4, size.pixels())),
      strokes(gpu::Buffer::create(device, gpu::Element::word, size.pixels())),
      pose(gpu::Buffer::create(device, gpu::Element::vec4, 2)),
      outdated(gpu::Buffer::create(device, gpu::Element::word, 1)),
      nearest(gpu::Buffer::create(device, gpu::Element::word, tiles().pixels())),
      farthest(gpu::Buffer::create(device, gpu::Element::word, tiles().pixels())),
      start(gpu::Buffer::create(device, gpu::Element::scalar, rays().pixels())) {}

Volume::Volume(const std::shared_ptr<gpu::Device>& device, const Params& params)
    : device_(device),
      params_(params),
      entries_(std::bit_ceil(kEntriesABlock * params.blocks) / 2),
      allocate_(device),
      list_blocks_(device),
      integrate_(device, {}, kColumns),
      ranges_(device),
      approach_(device),
      march_(device),
      normals_(device),
      outdated_(device),
      table_(gpu::Buffer::create(device, gpu::Element::word, 2ULL * entries_)),
      keys_(gpu::Buffer::create(device, gpu::Element::word, params.blocks)),
      fresh_(gpu::Buffer::create(device, gpu::Element::word, params.blocks)),
      list_(gpu::Buffer::create(device, gpu::Element::word, params.blocks)),
      colored_(gpu::Buffer::create(device, gpu::Element::word, params.blocks)),
      voxels_(gpu::Buffer::create(device, gpu::Element::word,
                                  uint64_t{params.blocks} * depth_allocate::kBlockVoxels)),
      colors_(gpu::Buffer::create(device, gpu::Element::word,
                                  uint64_t{params.blocks} * 2 * depth_allocate::kBlockVoxels)) {
  std::vector<uint32_t> places(params.blocks), start(depth_allocate::kStateWords);
  std::iota(places.rbegin(), places.rend(), 0U);
  start[1] = start[2] = 1;
  start[depth_allocate::kFree] = params.blocks;
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

VolumeData Volume::data() const {
  gpu::Commands commands(device_);
  const auto read = [&](const gpu::BufferPtr& buffer, uint64_t words) {
    const auto to = gpu::Buffer::create(device_, gpu::Element::word, std::max<uint64_t>(words, 1),
                                        gpu::Memory::readback);
    commands.begin();
    if (words > 0) commands.copy(buffer, to, words * sizeof(uint32_t));
    commands.submit();
    commands.wait();
    const auto* from = to->map_as<uint32_t>();
    return std::vector<uint32_t>(from, from + words);
  };
  VolumeData data{params_.voxel, params_.truncation, read(keys_, params_.blocks), {}, {}};
  // Places are taken in order; some may have been given back.
  constexpr uint64_t kVoxels = depth_allocate::kBlockVoxels;
  while (!data.keys.empty() && data.keys.back() == kNoBlock) data.keys.pop_back();
  const uint64_t places = data.keys.size();
  data.voxels = read(voxels_, places * kVoxels);
  data.colors = read(colors_, places * 2 * kVoxels);
  uint64_t blocks = 0;
  for (uint64_t place = 0; place < places; ++place) {
    if (data.keys[place] == kNoBlock) continue;
    data.keys[blocks] = data.keys[place];
    std::copy_n(&data.voxels[place * kVoxels], kVoxels, &data.voxels[blocks * kVoxels]);
    std::copy_n(&data.colors[2 * place * kVoxels], 2 * kVoxels, &data.colors[2 * blocks * kVoxels]);
    ++blocks;
  }
  data.keys.resize(blocks);
  data.voxels.resize(blocks * kVoxels);
  data.colors.resize(blocks * 2 * kVoxels);
  return data;
}

void Volume::restore(const VolumeData& data) {
  changed();
  const size_t blocks = data.keys.size();
  if (data.voxel != params_.voxel || data.truncation != params_.truncation)
    throw Error(ErrorKind::limit, "its voxels have a side of " + std::to_string(data.voxel) +
                                      " m, and those here " + std::to_string(params_.voxel));
  if (blocks > params_.blocks)
    throw Error(ErrorKind::limit, "it has " + std::to_string(blocks) +
                                      " blocks, and there is memory for " +
                                      std::to_string(params_.blocks));
  std::vector<uint32_t> table(2ULL * entries_, kNoBlock), colored(blocks),
      state(depth_allocate::kStateWords);
  for (uint32_t block = 0; block < blocks; ++block) {
    uint32_t entry = hash_of(data.keys[block]) & table_mask();
    while (table[2ULL * entry] != kNoBlock) entry = (entry + 1) & table_mask();
    table[2ULL * entry] = data.keys[block];
    table[2ULL * entry + 1] = block;
    const uint32_t* sure = &data.colors[(2ULL * block + 1) * depth_allocate::kBlockVoxels];
    colored[block] = static_cast<uint32_t>(std::count_if(
        sure, sure + depth_allocate::kBlockVoxels, [](uint32_t word) { return word >> 16 > 0; }));
  }
  state[1] = state[2] = 1;
  state[depth_allocate::kFree] = params_.blocks - static_cast<uint32_t>(blocks);
  gpu::Commands commands(device_);
  commands.begin();
  record_clear(commands);
  const std::pair<const gpu::BufferPtr&, const std::vector<uint32_t>&> parts[] = {
      {table_, table},     {state_, state},        {keys_, data.keys},
      {colored_, colored}, {voxels_, data.voxels}, {colors_, data.colors}};
  for (const auto& [to, words] : parts) {
    if (words.empty()) continue;
    const auto from =
        gpu::Buffer::create(device_, gpu::Element::word, words.size(), gpu::Memory::upload);
    std::ranges::copy(words, from->map_as<uint32_t>());
    commands.copy(from, to, from->bytes());
  }
  commands.submit();
  commands.wait();
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
  changed();
  const float truncation = params_.truncation * params_.voxel;
  // The counts of this frame; they stand beside each other.
  constexpr uint64_t kFrom = depth_allocate::kRefused * sizeof(uint32_t),
                     kTo = (depth_allocate::kMade + 1) * sizeof(uint32_t);
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
                          View& view) {
  constexpr float kPixels = 0.5F, kVoxels = 1.0F / 3;
  const bool changed = view.version != version_ || view.lens.values() != lens.values();
  view.version = version_;
  view.lens = lens;
  commands.dispatch(outdated_, {.pose = pose, .view_pose = view.pose, .outdated = view.outdated},
                    {.max_turn = kPixels / std::max(lens.fx, lens.fy),
                     .max_shift = kVoxels * params_.voxel,
                     .changed = uint32_t{changed}},
                    gpu::Items{1});
  record_list(commands, lens, view.extent, view.pose);
  commands.fill(view.nearest, std::bit_cast<uint32_t>(std::numeric_limits<float>::max()));
  commands.fill(view.farthest);
  const Extent tiles = view.tiles();
  commands.when(view.outdated, 0, [&] {
    commands.dispatch(ranges_,
                      {.list = list_,
                       .state = state_,
                       .keys = keys_,
                       .pose = view.pose,
                       .nearest = view.nearest,
                       .farthest = view.farthest},
                      {.lens = lens.values(),
                       .tiles = tiles,
                       .voxel = params_.voxel,
                       .min_depth = params_.min_depth},
                      params_.blocks);
    const Extent rays = view.rays();
    commands.dispatch(approach_,
                      {.table = table_,
                       .voxels = voxels_,
                       .nearest = view.nearest,
                       .farthest = view.farthest,
                       .pose = view.pose,
                       .start = view.start},
                      {.lens = lens.values(),
                       .size = rays,
                       .tiles = tiles.width,
                       .table_mask = entries_ - 1,
                       .voxel = params_.voxel,
                       .truncation = params_.truncation * params_.voxel},
                      static_cast<uint32_t>(rays.pixels()));
    commands.dispatch(march_,
                      {.table = table_,
                       .voxels = voxels_,
                       .colors = colors_,
                       .start = view.start,
                       .farthest = view.farthest,
                       .pose = view.pose,
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
  });
}

}  // namespace inverse
