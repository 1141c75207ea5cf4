// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_color.hpp"

#include <algorithm>

#include "kernels/gpu/reduce.hpp"
#include "kernels/image/pack4.hpp"

namespace inverse {
namespace {
using Scene = shaders::intrinsic_light_color_scene;
constexpr uint32_t kLanes = 8;  // of white.comp, which works on one
}  // namespace

LightColor::LightColor(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : extent_(extent),
      factor_((std::max(extent.width, extent.height) + Scene::LIGHT_POINTS - 1) /
              Scene::LIGHT_POINTS),
      points_kernel_(device),
      scene_(device, {}, gpu::kOneGroup),
      white_(device, {}, kLanes),
      slopes_(device, {1, 1}) {
  const auto cells = [&](uint32_t length) { return (length + factor_ - 1) / factor_; };
  cells_ = {cells(extent.width), cells(extent.height)};
  points_ = gpu::Buffer::create(device, gpu::Element::vec4, cells_.pixels());
  light_ = gpu::Buffer::create(device, gpu::Element::vec4, Scene::LIGHT_SIZE);
}

void LightColor::record(gpu::Commands& commands, const gpu::BufferPtr& frame, const Params& params,
                        bool first) {
  if (first) commands.fill(light_);
  commands.dispatch(points_kernel_, {.frame = frame, .points = points_},
                    {.size = extent_, .cells = cells_, .factor = factor_},
                    line_of(cells_.pixels()));
  commands.dispatch(scene_, {.points = points_, .light = light_},
                    {.count = static_cast<uint32_t>(cells_.pixels()),
                     .first = first,
                     .slope = std::clamp(params.slope.value_or(0.0F), -kMaxSlope, kMaxSlope)},
                    {});
}

PlanePtr LightColor::record_slope(gpu::Commands& commands, const gpu::BufferPtr& scale) {
  PlanePtr slope = slopes_.acquire();
  commands.dispatch(white_, {.light = light_, .scale = scale, .slope = slope->buffer}, {});
  return slope;
}

}  // namespace inverse
