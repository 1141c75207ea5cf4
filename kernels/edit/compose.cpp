#include "compose.hpp"

#include <algorithm>

#include "kernels/gpu/shaders.hpp"

INVERSE_SHADER(edit_compose);
INVERSE_SHADER(edit_recombine);

namespace inverse {
namespace {

constexpr uint32_t kRows = 4;  // edit.glsl
// MODE in compose.comp; the first three are Residual's.
constexpr uint32_t kDifference = 3, kMask = 4;

struct Push {
  uint32_t size[2];
  float strength;
};

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
  return run(commands, kDifference, layers, Role::intrinsic, 1);
}

PlanePtr Compose::record_mask(gpu::Commands& commands, const Layers& layers) {
  return run(commands, kMask, layers, Role::mask, 1);
}

PlanePtr Compose::recombine(gpu::Commands& commands, bool difference, const Layers& layers,
                            float strength) {
  PlanePtr picture = planes_.acquire();
  gpu::KernelPtr& kernel = recombine_[difference];
  if (!kernel) kernel = device_->kernel(shaders::edit_recombine, {difference ? 1U : 0U});
  commands.dispatch(kernel,
                    {layers[Role::input]->buffer, layers[Role::diffuse]->buffer,
                     layers[Role::specular]->buffer, picture->buffer},
                    Push{{layers.extent.width, layers.extent.height}, strength},
                    {layers.extent.width, (layers.extent.height - 1) / kRows + 1});
  return picture;
}

PlanePtr Compose::run(gpu::Commands& commands, uint32_t mode, const Layers& layers, Role now,
                      float strength) {
  PlanePtr picture = planes_.acquire();
  const bool light = layers.global() && mode != kMask;
  const Role before = light ? Role::model_light : Role::model;
  gpu::KernelPtr& kernel = kernels_[mode][light ? 1 : 0];
  if (!kernel) kernel = device_->kernel(shaders::edit_compose, {mode, light ? 1U : 0U});
  commands.dispatch(
      kernel,
      {layers[Role::input]->buffer, layers[Role::model]->buffer, layers[now]->buffer,
       layers[before]->buffer, layers[light ? Role::light : Role::model]->buffer, picture->buffer},
      Push{{layers.extent.width, layers.extent.height}, strength},
      {layers.extent.width, (layers.extent.height - 1) / kRows + 1});
  return picture;
}

}  // namespace inverse
