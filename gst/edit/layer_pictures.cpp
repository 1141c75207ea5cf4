// SPDX-License-Identifier: LGPL-2.1-or-later
#include "layer_pictures.hpp"

#include <string>

#include "common/error.hpp"

namespace inverse {

Picture LayerPictures::draw(gpu::Commands& commands, const Layers& layers, SplitLayer layer,
                            const SplitParams& params, const char* element, uint32_t base) {
  using What = LightPicture::What;
  Picture picture{layers[Role::input]};
  switch (layer) {
    case SplitLayer::reflectance:
      return {layers[Role::intrinsic], false, params.reflectance_scale};
    case SplitLayer::shading:
      picture = light_.shading(commands, layers);
      picture.gain = params.shading_scale;
      break;
    case SplitLayer::direct:
    case SplitLayer::indirect:
    case SplitLayer::bounced:
      picture = light_.draw(commands, layers,
                            layer == SplitLayer::direct     ? What::direct
                            : layer == SplitLayer::indirect ? What::indirect
                                                            : What::layer,
                            element, base);
      picture.gain = params.shading_scale;
      break;
    case SplitLayer::diffuse:
      return {layers[Role::diffuse]};
    case SplitLayer::specular:
      return {layers[Role::specular]};
    case SplitLayer::mirror:
      return {layers[Role::specular], true, params.mirror_scale};
    case SplitLayer::mask:
      return mask(commands, layers, element);
    default:
      break;
  }
  return picture;
}

Picture LayerPictures::mask(gpu::Commands& commands, const Layers& layers, const char* element) {
  if (layers.material()) return {layers[Role::diffuse], true};
  if (!layers[Role::mask])
    throw Error(ErrorKind::unsupported, std::string("these layers have no mask for pad mask of ") +
                                            element +
                                            "; set write-mask=true on an editor before it");
  if (!compose_ || device_ != commands.device() || extent_ != layers.extent) {
    device_ = commands.device();
    extent_ = layers.extent;
    compose_.emplace(device_, extent_);
  }
  return {compose_->record_mask(commands, layers)};
}

}  // namespace inverse
