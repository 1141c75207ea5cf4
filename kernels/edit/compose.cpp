// SPDX-License-Identifier: LGPL-2.1-or-later
#include "compose.hpp"

#include <algorithm>

#include "kernels/edit_compose.spv.hpp"
#include "kernels/edit_recombine.spv.hpp"

namespace inverse {
namespace {

using Mode = shaders::edit_compose;  // its first three are Residual's
constexpr uint32_t kRows = Mode::kRows;

}  // namespace

Compose::Compose(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device), planes_(device, extent) {}

PlanePtr Compose::record(gpu::Commands& commands, const Layers& layers,
                         const ComposeParams& params) {
  const bool wanted = params.strength > 0;
  if (wanted && layers.material())
    return recombine(commands, false, layers, std::min(params.strength, 1.0f));
  if (!wanted || (!layers.edited() && params.residual != Residual::none))
    return layers[Role::input];
  return run(commands, static_cast<uint32_t>(params.residual), layers, Role::intrinsic,
             std::min(params.strength, 1.0f));
}

PlanePtr Compose::record_difference(gpu::Commands& commands, const Layers& layers) {
  if (layers.material()) return recombine(commands, true, layers, 1);
  return run(commands, Mode::kDifference, layers, Role::intrinsic, 1);
}

PlanePtr Compose::record_mask(gpu::Commands& commands, const Layers& layers) {
  return run(commands, Mode::kMask, layers, Role::mask, 1);
}

PlanePtr Compose::recombine(gpu::Commands& commands, bool difference, const Layers& layers,
                            float strength) {
  PlanePtr picture = planes_.acquire();
  commands.dispatch_rows(gpu::Program<shaders::edit_recombine>(device_, {.difference = difference}),
                         {.frame = layers[Role::input]->buffer,
                          .diffuse = layers[Role::diffuse]->buffer,
                          .specular = layers[Role::specular]->buffer,
                          .picture = gpu::by_rows(picture->buffer)},
                         {.size = layers.extent, .strength = strength, .first_row = 0},
                         {layers.extent.width, layers.extent.height, kRows});
  return picture;
}

PlanePtr Compose::run(gpu::Commands& commands, uint32_t mode, const Layers& layers, Role now,
                      float strength) {
  PlanePtr picture = planes_.acquire();
  const bool light = layers.global() && mode != Mode::kMask;
  const PlanePtr& slope = layers[Role::slope];
  const Role before = light ? Role::model_light : Role::model;
  commands.dispatch_rows(
      gpu::Program<Mode>(device_, {.mode = mode, .light = light, .slope = slope != nullptr}),
      {.frame = layers[Role::input]->buffer,
       .model = layers[Role::model]->buffer,
       .intrinsic = layers[now]->buffer,
       .model_light = layers[before]->buffer,
       .light = layers[light ? Role::light : Role::model]->buffer,
       .slope = (slope ? slope : layers[Role::model])->buffer,
       .picture = gpu::by_rows(picture->buffer)},
      {.size = layers.extent, .strength = strength, .first_row = 0},
      {layers.extent.width, layers.extent.height, kRows});
  return picture;
}

}  // namespace inverse
