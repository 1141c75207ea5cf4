#include "light_picture.hpp"

#include "common/error.hpp"
#include "kernels/gpu/shaders.hpp"

INVERSE_SHADER(image_view_light_picture);

namespace inverse {
namespace {

constexpr uint32_t kRows = 4;  // light_picture.comp

}  // namespace

LightPicture::LightPicture(const std::shared_ptr<gpu::Device>& device) : device_(device) {}

void LightPicture::record(gpu::Commands& commands, const Layers& layers, What what,
                          const Plane& target, uint32_t base) const {
  if (!layers.global() || base >= kMaxBases)
    throw Error(ErrorKind::internal, "no such light to draw");
  const PlanePtr& shares = layers[indirect_role(base / 4)];
  if (what == What::layer && (!shares || !layers[Role::bases])) {
    commands.fill(target.buffer);
    return;
  }
  const PlanePtr& light = layers[Role::light];
  const Extent size = layers.extent;
  const struct { uint32_t width, height, base; } push{size.width, size.height, base};
  const bool layer = what == What::layer;
  const PlanePtr& lamp = layers[Role::lamp];
  commands.dispatch(
      device_->kernel(shaders::image_view_light_picture,
                      {static_cast<uint32_t>(what), lamp ? 1U : 0U}),
      {layers[Role::intrinsic]->buffer, light->buffer, layer ? shares->buffer : light->buffer,
       layer ? layers[Role::bases]->buffer : light->buffer, lamp ? lamp->buffer : light->buffer,
       target.buffer},
      push, {size.width, (size.height - 1) / kRows + 1});
}

}  // namespace inverse
