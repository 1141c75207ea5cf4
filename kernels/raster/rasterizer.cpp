#include "rasterizer.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "kernels/gpu/shaders.hpp"

INVERSE_SHADER(raster_place);
INVERSE_SHADER(raster_edges);
INVERSE_SHADER(raster_bin);
INVERSE_SHADER(raster_draw);
INVERSE_SHADER(raster_depth);

namespace inverse {
namespace {

constexpr uint32_t kBlock = 8;            // pixels along a block, as in visible.glsl
constexpr uint32_t kMaxGroups = 512;      // beyond this number, groups are larger instead
constexpr uint64_t kMaxWords = 1U << 21;  // of bits; beyond this number, tiles are larger instead
constexpr uint32_t kMinGroup = 32;        // visible.glsl tests this number of triangles at once
constexpr uint32_t kLargestGroup = 256;

uint32_t divided(uint32_t a, uint32_t b) { return (a + b - 1) / b; }

/// One invocation per pixel, in whole blocks.
gpu::Items blocks(Extent extent) {
  return {divided(extent.width, kBlock) * kBlock * kBlock, divided(extent.height, kBlock)};
}

}  // namespace

struct Rasterizer::Push {
  uint32_t size[2], tile, columns, words, group, side;
};

Rasterizer::Rasterizer(const std::shared_ptr<gpu::Device>& device, const Mesh& mesh)
    : place_(device->kernel(shaders::raster_place)),
      edges_(device->kernel(shaders::raster_edges)),
      bin_(device->kernel(shaders::raster_bin)),
      draw_(device->kernel(shaders::raster_draw)),
      depth_(device->kernel(shaders::raster_depth)),
      corner_count_(static_cast<uint32_t>(mesh.positions.size())),
      triangles_(static_cast<uint32_t>(mesh.triangles())),
      group_(std::clamp(std::bit_ceil(divided(triangles_, kMaxGroups)), kMinGroup, kLargestGroup)),
      groups_(divided(triangles_, group_)) {
  using gpu::Buffer, gpu::Element, gpu::Memory;
  const uint64_t records = uint64_t{4} * groups_ * group_;
  const auto corners =
      Buffer::create(device, Element::vec4, uint64_t{2} * corner_count_, Memory::upload);
  const auto indices = Buffer::create(device, Element::word, mesh.indices.size(), Memory::upload);
  placed_ = Buffer::create(device, Element::vec4, corners->count());
  records_ = Buffer::create(device, Element::vec4, records);
  boxes_ = Buffer::create(device, Element::vec4, groups_);
  bounds_ = Buffer::create(device, Element::vec4, records / 4);
  auto* corner = corners->map_as<std::array<float, 4>>();
  for (size_t i = 0; i < corner_count_; ++i) {
    const Mesh::Vec3 &p = mesh.positions[i], &n = mesh.normals[i];
    *corner++ = {p[0], p[1], p[2], 0};
    *corner++ = {n[0], n[1], n[2], 0};
  }
  memcpy(indices->map(), mesh.indices.data(), indices->bytes());
  gpu::Commands commands(device);
  commands.begin();
  corners_ = commands.resident(corners);
  indices_ = commands.resident(indices);
  commands.submit();
  commands.wait();
}

Rasterizer::Push Rasterizer::prepare(gpu::Commands& commands, const MeshView& view, Extent extent) {
  const uint32_t words = divided(groups_, 32);
  uint32_t tile = kBlock;
  const auto along = [&](uint32_t pixels) { return divided(pixels, tile); };
  while (uint64_t{along(extent.width)} * along(extent.height) * words > kMaxWords) tile *= 2;
  const uint32_t tiles = along(extent.width) * along(extent.height);
  if (!bits_ || bits_->count() < uint64_t{tiles} * words)
    bits_ = gpu::Buffer::create(corners_->device(), gpu::Element::word, uint64_t{tiles} * words);
  const struct {
    float x[4], y[4], z[4], scale;
    uint32_t count;
  } placing{{view.turn[0][0], view.turn[0][1], view.turn[0][2], view.x},
            {view.turn[1][0], view.turn[1][1], view.turn[1][2], view.y},
            {view.turn[2][0], view.turn[2][1], view.turn[2][2], 0},
            view.scale,
            corner_count_};
  commands.dispatch(place_, {corners_, placed_}, placing,
                    {std::min(corner_count_, 65536U), divided(corner_count_, 65536)});
  const struct { uint32_t groups, size, triangles; } edging{groups_, group_, triangles_};
  commands.dispatch(edges_, {placed_, indices_, records_, boxes_, bounds_}, edging, {groups_});
  const struct {
    uint32_t columns, tile, groups, words;
  } binning{along(extent.width), tile, groups_, words};
  commands.dispatch(bin_, {boxes_, bits_}, binning,
                    {along(extent.width) * words, along(extent.height)});
  return {{extent.width, extent.height}, tile, along(extent.width), words, group_, 0};
}

void Rasterizer::draw(gpu::Commands& commands, const MeshView& view, const Plane& table,
                      const Plane& picture) {
  Push push = prepare(commands, view, picture.extent);
  push.side = table.extent.width;
  commands.dispatch(draw_, {records_, bits_, bounds_, placed_, table.buffer, picture.buffer}, push,
                    blocks(picture.extent));
}

void Rasterizer::depth(gpu::Commands& commands, const MeshView& view, const Plane& picture) {
  const Push push = prepare(commands, view, picture.extent);
  commands.dispatch(depth_, {records_, bits_, bounds_, picture.buffer}, push,
                    blocks(picture.extent));
}

}  // namespace inverse
