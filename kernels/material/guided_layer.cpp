#include "guided_layer.hpp"

#include "../gpu/shaders.hpp"

INVERSE_SHADER(material_guided_lines);
INVERSE_SHADER(material_guided_mean);
INVERSE_SHADER(material_guided_points);

namespace inverse {

GuidedLayer::GuidedLayer(const std::shared_ptr<gpu::Device>& device, uint32_t side)
    : side_(side),
      find_points_(device->kernel(shaders::material_guided_points)),
      find_lines_(device->kernel(shaders::material_guided_lines)),
      find_mean_(device->kernel(shaders::material_guided_mean)) {
  for (gpu::BufferPtr* buffer : {&points_, &lines_, &mean_of_lines_})
    *buffer = gpu::Buffer::create(device, gpu::Element::vec4, side * side);
}

void GuidedLayer::record(gpu::Commands& commands, const gpu::BufferPtr& masked,
                         const gpu::BufferPtr& codes) {
  const gpu::Items each{side_ * side_};
  const auto side = static_cast<int32_t>(side_);
  commands.dispatch(find_points_, {masked, codes, points_}, side * side, each);
  commands.dispatch(find_lines_, {points_, lines_}, side, each);
  commands.dispatch(find_mean_, {lines_, mean_of_lines_}, side, each);
}

}  // namespace inverse
