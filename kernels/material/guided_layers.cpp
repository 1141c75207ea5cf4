#include "guided_layers.hpp"

#include "../gpu/shaders.hpp"

INVERSE_SHADER(material_guided_colors);
INVERSE_SHADER(material_guided_lines);
INVERSE_SHADER(material_guided_mean);
INVERSE_SHADER(material_guided_planes);
INVERSE_SHADER(material_guided_points);

namespace inverse {

GuidedLayers::GuidedLayers(const std::shared_ptr<gpu::Device>& device, uint32_t side)
    : side_(side),
      colors_(device->kernel(shaders::material_guided_colors)),
      planes_(device->kernel(shaders::material_guided_planes)),
      points_(device->kernel(shaders::material_guided_points)),
      lines_(device->kernel(shaders::material_guided_lines)),
      mean_of_planes_(device->kernel(shaders::material_guided_mean, {0})),
      mean_of_lines_(device->kernel(shaders::material_guided_mean, {1})) {
  for (gpu::BufferPtr* buffer : {&guide_, &fits_, &mask_, &specular_})
    *buffer = gpu::Buffer::create(device, gpu::Element::vec4, side * side);
}

void GuidedLayers::record_mask(gpu::Commands& commands, const gpu::BufferPtr& image,
                               const gpu::BufferPtr& probability) {
  const gpu::Items each{side_ * side_};
  const auto side = static_cast<int32_t>(side_);
  commands.dispatch(colors_, {image, probability, guide_}, side * side, each);
  commands.dispatch(planes_, {guide_, fits_}, side, each);
  commands.dispatch(mean_of_planes_, {guide_, fits_, mask_}, side, each);
}

void GuidedLayers::record_specular(gpu::Commands& commands, const gpu::BufferPtr& masked,
                                   const gpu::BufferPtr& codes) {
  const gpu::Items each{side_ * side_};
  const auto side = static_cast<int32_t>(side_);
  commands.dispatch(points_, {masked, codes, guide_}, side * side, each);
  commands.dispatch(lines_, {guide_, fits_}, side, each);
  commands.dispatch(mean_of_lines_, {guide_, fits_, specular_}, side, each);
}

}  // namespace inverse
