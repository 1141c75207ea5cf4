// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_picture.hpp"

#include "common/error.hpp"
#include "kernels/image_view_light_picture.spv.hpp"

namespace inverse {
LightPicture::LightPicture(const std::shared_ptr<gpu::Device>& device) : device_(device) {}

void LightPicture::record(gpu::Commands& commands, const Layers& layers, What what,
                          const Plane& target, uint32_t base) const {
  const PlanePtr& slope = layers[Role::slope];
  const bool plain = !layers.global() && slope && what == What::all;
  if (!(layers.global() || plain) || base >= kMaxBases)
    throw Error(ErrorKind::internal, "no such light to draw");
  const PlanePtr& shares = layers[indirect_role(base / 4)];
  if (what == What::layer && (!shares || !layers[Role::bases])) {
    commands.fill(target.buffer);
    return;
  }
  const PlanePtr& light = layers[plain ? Role::intrinsic : Role::light];
  const Extent size = layers.extent;
  using Shader = shaders::image_view_light_picture;
  const bool layer = what == What::layer;
  const PlanePtr& lamp = layers[Role::lamp];
  commands.dispatch_rows(gpu::Program<Shader>(device_, {.what = static_cast<uint32_t>(what),
                                                        .lamp = lamp != nullptr,
                                                        .slope = slope != nullptr,
                                                        .plain = plain}),
                         {.intrinsic = layers[Role::intrinsic]->buffer,
                          .light = light->buffer,
                          .share = layer ? shares->buffer : light->buffer,
                          .bases = layer ? layers[Role::bases]->buffer : light->buffer,
                          .lamp = lamp ? lamp->buffer : light->buffer,
                          .slope = (slope ? slope : light)->buffer,
                          .picture = gpu::by_rows(target.buffer)},
                         {.size = size, .base = base, .first_row = 0},
                         {size.width, size.height, Shader::kRows});
}

}  // namespace inverse
