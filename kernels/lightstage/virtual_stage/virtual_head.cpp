// SPDX-License-Identifier: LGPL-2.1-or-later
#include "virtual_head.hpp"

#include <algorithm>
#include <cstring>

#include "kernels/lightstage_virtual_stage_shade.spv.hpp"
#include "kernels/lightstage_virtual_stage_surface.spv.hpp"

namespace inverse {
namespace {

// Work per submit, limited so that a device that also drives a display stays responsive.
constexpr uint64_t kSamplesAtOnce = uint64_t{1} << 23;
constexpr uint32_t kRaysAtOnce = uint32_t{1} << 18;

gpu::BufferPtr uploaded(const std::shared_ptr<gpu::Device>& device,
                        std::span<const HeadScene::Vec4> values) {
  return gpu::make_table(device, gpu::Element::vec4, std::as_bytes(values));
}

}  // namespace

HeadSurface make_head_surface(const std::shared_ptr<gpu::Device>& device, Extent extent) {
  const auto plane = [&] {
    return Plane{extent, gpu::Buffer::create(device, gpu::Element::vec4, extent.pixels())};
  };
  return {plane(), plane(), plane()};
}

void record_head_surface(gpu::Commands& commands, const HeadSurface& surface, const HeadView& view,
                         uint32_t first, uint32_t count) {
  const auto& device = commands.device();
  const HeadScene& head = virtual_head();
  const Extent extent = surface.position.extent;
  commands.dispatch(gpu::Program<shaders::lightstage_virtual_stage_surface>(device),
                    {.scene = uploaded(device, head.primitives),
                     .materials = uploaded(device, head.materials),
                     .position = surface.position.buffer,
                     .normal = surface.normal.buffer,
                     .albedo = surface.albedo.buffer},
                    {.width = extent.width,
                     .height = extent.height,
                     .primitives = head.count(),
                     .turn = view.turn,
                     .distance = view.distance,
                     .height_of_view = view.height,
                     .center = view.center,
                     .first = first,
                     .count = count},
                    {count});
}

bool render_head(OlatStack& stack, std::span<const Direction> lights, const HeadView& view,
                 const std::function<bool()>& go_on, uint32_t side) {
  const Extent extent = stack.extent();
  const auto& device = stack.chunks().front().images->device();
  const HeadScene& head = virtual_head();
  gpu::Commands commands(device);
  const HeadSurface surface =
      make_head_surface(device, {extent.width * side, extent.height * side});
  const auto samples = static_cast<uint32_t>(surface.position.extent.pixels());
  for (uint32_t first = 0; first < samples; first += kRaysAtOnce) {
    if (go_on && !go_on()) return false;
    commands.begin();
    record_head_surface(commands, surface, view, first, std::min(kRaysAtOnce, samples - first));
    commands.submit();
    commands.wait();
  }
  std::vector<HeadScene::Vec4> directions;
  for (const Direction& d : lights)
    directions.push_back(
        {static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2]), 0});
  const auto scene = uploaded(device, head.primitives), table = uploaded(device, directions);
  const gpu::Program<shaders::lightstage_virtual_stage_shade> shade(device);
  const auto pixels = static_cast<uint32_t>(extent.pixels());
  const auto eye = view.eye();
  const auto at_once = static_cast<uint32_t>(
      std::max<uint64_t>(1, kSamplesAtOnce / (extent.pixels() * side * side)));
  for (const OlatStack::Chunk& chunk : stack.chunks())
    for (uint32_t first = 0; first < chunk.count; first += at_once) {
      if (go_on && !go_on()) return false;
      const uint32_t count = std::min(at_once, chunk.count - first);
      commands.begin();
      commands.dispatch(shade,
                        {.scene = scene,
                         .position = surface.position.buffer,
                         .normal = surface.normal.buffer,
                         .albedo = surface.albedo.buffer,
                         .lights = table,
                         .olats = chunk.images},
                        {.width = extent.width,
                         .height = extent.height,
                         .side = side,
                         .first = chunk.first + first,
                         .count = count,
                         .target = first,
                         .primitives = head.count(),
                         .eye_x = eye[0],
                         .eye_y = eye[1],
                         .eye_z = eye[2]},
                        {pixels, count});
      commands.submit();
      commands.wait();
    }
  return true;
}

}  // namespace inverse
