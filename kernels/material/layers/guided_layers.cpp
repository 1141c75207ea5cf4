// SPDX-License-Identifier: LGPL-2.1-or-later
#include "guided_layers.hpp"

namespace inverse {

GuidedLayers::GuidedLayers(const std::shared_ptr<gpu::Device>& device, uint32_t side)
    : side_(side),
      mask_points_(device),
      mask_fit_(device),
      mask_mean_(device, {.beyond = false}),
      specular_points_(device),
      specular_fit_(device),
      specular_mean_(device, {.beyond = true}) {
  for (gpu::BufferPtr* buffer : {&mask_, &specular_, &points_, &fits_})
    *buffer = gpu::Buffer::create(device, gpu::Element::vec4, side * side);
}

void GuidedLayers::record_mask(gpu::Commands& commands, const gpu::BufferPtr& image,
                               const gpu::BufferPtr& probability) {
  commands.dispatch(mask_points_, {.image = image, .probability = probability, .result = points_},
                    {.count = count()}, each());
  commands.dispatch(mask_fit_, {.points = points_, .result = fits_}, {.side = side()}, each());
  commands.dispatch(mask_mean_, {.lines = fits_, .result = mask_}, {.side = side()}, each());
}

void GuidedLayers::record_specular(gpu::Commands& commands, const gpu::BufferPtr& masked,
                                   const gpu::BufferPtr& codes) {
  commands.dispatch(specular_points_, {.masked = masked, .codes = codes, .result = points_},
                    {.count = count()}, each());
  commands.dispatch(specular_fit_, {.points = points_, .result = fits_}, {.side = side()}, each());
  commands.dispatch(specular_mean_, {.lines = fits_, .result = specular_}, {.side = side()},
                    each());
}

}  // namespace inverse
