// SPDX-License-Identifier: LGPL-2.1-or-later
#include "rasterizer.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace inverse {
namespace {

using Visible = shaders::material_raster_draw;
constexpr uint32_t kBlock = Visible::kBlock;
constexpr uint32_t kMaxGroups = 512;      // beyond this number, groups are larger instead
constexpr uint64_t kMaxWords = 1U << 21;  // of bits; beyond this number, tiles are larger instead
constexpr uint32_t kMinGroup = Visible::kTogether;
constexpr uint32_t kLargestGroup = 256;

uint32_t divided(uint32_t a, uint32_t b) { return (a + b - 1) / b; }

/// One invocation per pixel, in whole blocks.
gpu::Items blocks(Extent extent) {
  return {divided(extent.width, kBlock) * kBlock * kBlock, divided(extent.height, kBlock)};
}

}  // namespace

Rasterizer::Rasterizer(const std::shared_ptr<gpu::Device>& device, const Mesh& mesh)
    : place_(device),
      edges_(device),
      bin_(device),
      draw_(device),
      depth_(device),
      corner_count_(static_cast<uint32_t>(mesh.positions.size())),
      triangles_(static_cast<uint32_t>(mesh.triangles())),
      group_(std::clamp(std::bit_ceil(divided(triangles_, kMaxGroups)), kMinGroup, kLargestGroup)),
      groups_(divided(triangles_, group_)) {
  using gpu::Buffer, gpu::Element, gpu::Memory;
  const uint64_t records = uint64_t{4} * groups_ * group_;
  std::vector<std::array<float, 4>> corners;
  for (size_t i = 0; i < corner_count_; ++i) {
    const Mesh::Vec3 &p = mesh.positions[i], &n = mesh.normals[i];
    corners.push_back({p[0], p[1], p[2], 0});
    corners.push_back({n[0], n[1], n[2], 0});
  }
  corners_ = gpu::make_table(device, Element::vec4, corners);
  indices_ = gpu::make_table(device, Element::word, mesh.indices);
  placed_ = Buffer::create(device, Element::vec4, corners_->count());
  records_ = Buffer::create(device, Element::vec4, records);
  boxes_ = Buffer::create(device, Element::vec4, groups_);
  bounds_ = Buffer::create(device, Element::vec4, records / 4);
}

Rasterizer::Grid Rasterizer::prepare(gpu::Commands& commands, const MeshView& view, Extent extent) {
  const uint32_t words = divided(groups_, 32);
  uint32_t tile = kBlock;
  const auto along = [&](uint32_t pixels) { return divided(pixels, tile); };
  while (uint64_t{along(extent.width)} * along(extent.height) * words > kMaxWords) tile *= 2;
  const uint32_t tiles = along(extent.width) * along(extent.height);
  if (!bits_ || bits_->count() < uint64_t{tiles} * words)
    bits_ = gpu::Buffer::create(corners_->device(), gpu::Element::word, uint64_t{tiles} * words);
  commands.dispatch(place_, {.corners = corners_, .placed = placed_},
                    {.x = {view.turn[0][0], view.turn[0][1], view.turn[0][2], view.x},
                     .y = {view.turn[1][0], view.turn[1][1], view.turn[1][2], view.y},
                     .z = {view.turn[2][0], view.turn[2][1], view.turn[2][2], view.z},
                     .lens = view.lens,
                     .scale = view.scale,
                     .count = corner_count_},
                    {corner_count_});
  commands.dispatch(edges_,
                    {.placed = placed_,
                     .indices = indices_,
                     .records = records_,
                     .boxes = boxes_,
                     .bounds = bounds_},
                    {.groups = groups_, .size = group_, .triangles = triangles_}, {groups_});
  commands.dispatch(
      bin_, {.boxes = boxes_, .bits = bits_},
      {.columns = along(extent.width), .tile = tile, .groups = groups_, .words = words},
      {along(extent.width) * words, along(extent.height)});
  return {.lens = view.lens,
          .size = extent,
          .first = 0,
          .stride = extent.width,
          .tile = tile,
          .columns = along(extent.width),
          .words = words,
          .group = group_,
          .side = 0};
}

void Rasterizer::draw(gpu::Commands& commands, const MeshView& view, const Plane& table,
                      const Plane& picture) {
  Grid grid = prepare(commands, view, picture.extent);
  grid.side = table.extent.width;
  commands.dispatch(draw_,
                    {.records = records_,
                     .bits = bits_,
                     .bounds = bounds_,
                     .placed = placed_,
                     .LIT_TABLE = table.buffer,
                     .picture = picture.buffer},
                    grid, blocks(picture.extent));
}

void Rasterizer::draw_in_room(gpu::Commands& commands, const MeshView& view, const Plane& table,
                              const Room& room, const Plane& picture) {
  if (!draw_room_.kernel()) draw_room_ = {corners_->device()};
  Grid grid = prepare(commands, view, picture.extent);
  grid.side = table.extent.width;
  commands.dispatch(draw_room_,
                    {.records = records_,
                     .bits = bits_,
                     .bounds = bounds_,
                     .placed = placed_,
                     .LIT_TABLE = table.buffer,
                     .room = room.room,
                     .surface = room.surface,
                     .reached = room.reached,
                     .picture = picture.buffer},
                    grid, blocks(picture.extent));
}

void Rasterizer::depth(gpu::Commands& commands, const MeshView& view, const Plane& picture,
                       Extent corner, Extent part) {
  Grid grid = prepare(commands, view, part);
  grid.first = corner.height * picture.extent.width + corner.width;
  grid.stride = picture.extent.width;
  commands.dispatch(
      depth_, {.records = records_, .bits = bits_, .bounds = bounds_, .picture = picture.buffer},
      grid, blocks(part));
}

}  // namespace inverse
