// SPDX-License-Identifier: LGPL-2.1-or-later
#include "host_blocks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace inverse {
namespace {

using Shader = shaders::depth_streaming_leave;

constexpr uint32_t kGroup = 64;
constexpr uint64_t kWord = sizeof(uint32_t);
// Of InFlight::moved, in words.
constexpr uint64_t kLeft = 0, kTaken = 1, kOut = kTaken + Shader::kMoves;
// Blocks leave while fewer of the pool are free than one in so many.
constexpr uint32_t kFewFree = 8;
// How far out of sight blocks are that leave, and that come back.
constexpr float kLeaveMargin = 0.25F, kEnterMargin = 0.15F;  // meters
constexpr float kStep =
    0.25F;  // meters of distance from the camera, by which the farthest are found

/// The distance of a block to a camera that has it in sight, or nearly; negative: it has not.
float distance_in_sight(uint32_t key, const Pose& pose, const HostBlocks::Camera& camera,
                        const Volume::Params& params) {
  const float side = 8 * params.voxel, reach = 0.5F * std::sqrt(3.0F) * side + kEnterMargin;
  const auto block = VolumeData::block_of(key);
  std::array<float, 3> world{};
  for (size_t c = 0; c < 3; ++c) world[c] = side * (static_cast<float>(block[c]) + 0.5F);
  const auto center = to_camera(pose, world);
  if (!in_sight(camera.lens, camera.extent, params.max_depth, center, reach)) return -1;
  return std::hypot(center[0], center[1], center[2]);
}

}  // namespace

HostBlocks::Kernels::Kernels(const std::shared_ptr<gpu::Device>& device)
    : count(device, {.picks = false}),
      pick(device),
      move_out(device, {}, kGroup),
      insert(device),
      move_in(device, {}, kGroup) {}

void HostBlocks::make() {
  if (kernels_) return;
  kernels_ = std::make_unique<Kernels>(device_);
  std::vector<uint32_t> none(Shader::kLeavingWords, 0);
  none[1] = none[2] = 1;  // workgroups
  none_leaving_ = gpu::make_table(device_, gpu::Element::word, none);
  leaving_ = gpu::Buffer::create(device_, gpu::Element::word, none.size());
  moved_ = gpu::Buffer::create(device_, gpu::Element::word, Shader::kMovedWords);
  taken_ = gpu::Buffer::create(device_, gpu::Element::word, kMoves);
  for (InFlight& frame : frames_) {
    frame.entering =
        gpu::Buffer::create(device_, gpu::Element::word, Shader::kMovedWords, gpu::Memory::upload);
    frame.moved = gpu::Buffer::create(device_, gpu::Element::word, kOut + Shader::kMovedWords,
                                      gpu::Memory::readback);
  }
}

void HostBlocks::hear(uint64_t number) {
  InFlight& frame = frames_[number];
  if (!std::exchange(frame.moves, false)) return;
  const auto* words = frame.moved->map_as<uint32_t>();
  for (size_t n = 0; n < frame.sent.size(); ++n) {
    if (words[kTaken + n] != 0)
      blocks_.erase(frame.sent[n]);
    else
      blocks_[frame.sent[n]].sent = false;
  }
  frame.sent.clear();
  const uint32_t left = std::min(words[kLeft], uint32_t{kMoves});
  for (uint32_t n = 0; n < left; ++n) {
    const uint32_t* from = words + kOut + Shader::kMovedBlocks + uint64_t{Shader::kBlockWords} * n;
    blocks_[words[kOut + Shader::kMovedKeys + n]] = {Words(from, from + Shader::kBlockWords),
                                                     frame.strokes, false};
  }
}

void HostBlocks::record(gpu::Commands& commands, uint64_t number, Volume& volume,
                        const Camera& camera, const Known& known, uint64_t strokes) {
  for (uint64_t n = last_ - std::min<uint64_t>(last_, gpu::kFramesInFlight - 1);
       n <= last_ && n + gpu::kFramesInFlight <= number; ++n)
    hear(n);
  last_ = number;
  const uint32_t pool = volume.params().blocks;
  const bool out = known.free_blocks < pool / kFewFree && blocks_.size() < kMaxPools * pool;
  if (!out && blocks_.empty()) return;
  make();
  InFlight& frame = frames_[number];
  frame.strokes = strokes;
  // A frame that is never computed moves nothing.
  std::fill_n(frame.moved->map_as<uint32_t>(), kOut, 0U);
  if (out) record_out(commands, frame, volume, camera);
  record_in(commands, frame, volume, camera, known);
  if (frame.moves) {
    volume.changed();
    commands.stage("scene-blocks");
  }
}

void HostBlocks::record_out(gpu::Commands& commands, InFlight& frame, Volume& volume,
                            const Camera& camera) {
  const Volume::Params& params = volume.params();
  commands.copy(none_leaving_, leaving_, leaving_->bytes());
  const auto leave = [&](const auto& program) {
    commands.dispatch(program, {.keys = volume.keys(), .pose = camera.pose, .leaving = leaving_},
                      {.lens = camera.lens.values(),
                       .size = camera.extent,
                       .blocks = params.blocks,
                       .voxel = params.voxel,
                       .max_depth = params.max_depth,
                       .step = kStep,
                       .margin = kLeaveMargin},
                      params.blocks);
  };
  leave(kernels_->count);
  leave(kernels_->pick);
  commands.dispatch_indirect(kernels_->move_out,
                             {.leaving = leaving_,
                              .voxels = volume.voxels(),
                              .colors = volume.colors(),
                              .keys = volume.keys(),
                              .colored = volume.colored(),
                              .free_blocks = volume.free_blocks(),
                              .state = volume.state(),
                              .moved = moved_},
                             leaving_);
  commands.fill(volume.table(), VolumeData::kNoBlock);
  commands.dispatch(kernels_->insert, {.keys = volume.keys(), .table = volume.table()},
                    {.blocks = params.blocks, .table_mask = volume.table_mask()}, params.blocks);
  const std::array<gpu::Commands::CopyPart, 2> parts{
      {{.source = leaving_, .bytes = kWord, .target_offset = kLeft * kWord},
       {.source = moved_, .bytes = moved_->bytes(), .target_offset = kOut * kWord}}};
  commands.copy(parts, frame.moved);
  frame.moves = true;
}

void HostBlocks::record_in(gpu::Commands& commands, InFlight& frame, Volume& volume,
                           const Camera& camera, const Known& known) {
  std::vector<std::pair<float, uint32_t>> wanted;
  for (const auto& [key, block] : blocks_) {
    if (block.sent) continue;
    const float distance = distance_in_sight(key, known.pose, camera, volume.params());
    if (distance >= 0) wanted.emplace_back(distance, key);
  }
  const size_t count = std::min({wanted.size(), size_t{kMoves}, size_t{known.free_blocks} / 2});
  if (count == 0) return;
  std::ranges::partial_sort(wanted, wanted.begin() + static_cast<std::ptrdiff_t>(count));
  auto* words = frame.entering->map_as<uint32_t>();
  for (size_t n = 0; n < count; ++n) {
    Block& block = blocks_[wanted[n].second];
    block.sent = true;
    frame.sent.push_back(wanted[n].second);
    words[Shader::kMovedKeys + n] = wanted[n].second;
    words[Shader::kMovedOld + n] = uint32_t{block.strokes != frame.strokes};
    std::ranges::copy(block.words,
                      words + Shader::kMovedBlocks + uint64_t{Shader::kBlockWords} * n);
  }
  commands.dispatch(kernels_->move_in,
                    {.moved = frame.entering,
                     .free_blocks = volume.free_blocks(),
                     .table = volume.table(),
                     .keys = volume.keys(),
                     .voxels = volume.voxels(),
                     .colors = volume.colors(),
                     .colored = volume.colored(),
                     .state = volume.state(),
                     .taken = taken_},
                    {.table_mask = volume.table_mask()},
                    gpu::Items{kGroup * static_cast<uint32_t>(count), 1});
  commands.copy(taken_, frame.moved, count * kWord, 0, kTaken * kWord);
  frame.moves = true;
}

void HostBlocks::append_to(VolumeData& data) {
  for (uint64_t n = last_ - std::min<uint64_t>(last_, gpu::kFramesInFlight - 1); n <= last_; ++n)
    hear(n);
  constexpr size_t kVoxels = VolumeData::kBlockVoxels;
  const std::unordered_map<uint32_t, size_t> there = [&] {
    std::unordered_map<uint32_t, size_t> places;
    for (size_t n = 0; n < data.keys.size(); ++n) places.emplace(data.keys[n], n);
    return places;
  }();
  for (const auto& [key, block] : blocks_) {
    if (there.contains(key)) continue;  // seen anew since it left
    data.keys.push_back(key);
    const auto colors = block.words.begin() + kVoxels;
    data.voxels.insert(data.voxels.end(), block.words.begin(), colors);
    data.colors.insert(data.colors.end(), colors, block.words.end());
  }
}

void HostBlocks::take_rest(VolumeData& data, uint32_t room) {
  constexpr size_t kVoxels = VolumeData::kBlockVoxels;
  blocks_.clear();
  for (InFlight& frame : frames_) frame.sent.clear(), frame.moves = false;
  for (size_t n = room; n < data.keys.size(); ++n) {
    Words words(&data.voxels[n * kVoxels], &data.voxels[n * kVoxels] + kVoxels);
    words.insert(words.end(), &data.colors[2 * n * kVoxels],
                 &data.colors[2 * n * kVoxels] + 2 * kVoxels);
    blocks_[data.keys[n]] = {std::move(words), 0, false};
  }
  if (data.keys.size() <= room) return;
  data.keys.resize(room);
  data.voxels.resize(room * kVoxels);
  data.colors.resize(2 * room * kVoxels);
}

}  // namespace inverse
