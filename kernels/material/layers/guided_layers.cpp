#include "guided_layers.hpp"

#include "kernels/gpu/shaders.hpp"

INVERSE_SHADER(material_layers_guided_colors);
INVERSE_SHADER(material_layers_guided_lines);
INVERSE_SHADER(material_layers_guided_mean);
INVERSE_SHADER(material_layers_guided_planes);
INVERSE_SHADER(material_layers_guided_points);

namespace inverse {

GuidedLayers::GuidedLayers(const std::shared_ptr<gpu::Device>& device, uint32_t side)
    : side_(side),
      mask_{device->kernel(shaders::material_layers_guided_colors),
            device->kernel(shaders::material_layers_guided_planes),
            device->kernel(shaders::material_layers_guided_mean, {0}), nullptr},
      specular_{device->kernel(shaders::material_layers_guided_points),
                device->kernel(shaders::material_layers_guided_lines),
                device->kernel(shaders::material_layers_guided_mean, {1}), nullptr} {
  for (gpu::BufferPtr* buffer : {&mask_.result, &specular_.result, &points_, &fits_})
    *buffer = gpu::Buffer::create(device, gpu::Element::vec4, side * side);
}

void GuidedLayers::record_mask(gpu::Commands& commands, const gpu::BufferPtr& image,
                               const gpu::BufferPtr& probability) {
  record(commands, mask_, image, probability);
}

void GuidedLayers::record_specular(gpu::Commands& commands, const gpu::BufferPtr& masked,
                                   const gpu::BufferPtr& codes) {
  record(commands, specular_, masked, codes);
}

void GuidedLayers::record(gpu::Commands& commands, const Filter& filter,
                          const gpu::BufferPtr& guide, const gpu::BufferPtr& layer) {
  const gpu::Items each{side_ * side_};
  const auto side = static_cast<int32_t>(side_);
  commands.dispatch(filter.points, {guide, layer, points_}, side * side, each);
  commands.dispatch(filter.fit, {points_, fits_}, side, each);
  commands.dispatch(filter.mean, {points_, fits_, filter.result}, side, each);
}

}  // namespace inverse
