// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_pictures.hpp"

#include <string>

#include "common/error.hpp"
#include "gst/base/pads/missing_layers.hpp"

namespace inverse {

Picture LightPictures::draw(gpu::Commands& commands, const Layers& layers, LightPicture::What what,
                            const char* element, uint32_t base) {
  if (!layers.global())
    throw Error(ErrorKind::unsupported,
                "these layers are " + contents_of(layers) +
                    " and do not separate direct light from indirect, as " + element +
                    " is to show it; put globalintrinsic in the place of the decomposer before it");
  return drawn(commands, layers, what, base);
}

Picture LightPictures::drawn(gpu::Commands& commands, const Layers& layers, LightPicture::What what,
                             uint32_t base) {
  if (device_ != commands.device() || planes_->extent() != layers.extent) {
    device_ = commands.device();
    planes_.emplace(device_, layers.extent);
    light_.emplace(device_);
  }
  const PlanePtr target = planes_->acquire();
  light_->record(commands, layers, what, *target, base);
  return {target};
}

Picture LightPictures::shading(gpu::Commands& commands, const Layers& layers) {
  if (layers.global() || layers[Role::slope])
    return drawn(commands, layers, LightPicture::What::all, 0);
  return {layers[Role::intrinsic], true};
}

}  // namespace inverse
