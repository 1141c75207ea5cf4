#include "pyramid.hpp"

#include "kernels/gpu/shaders.hpp"

INVERSE_SHADER(image_halve);

namespace inverse {

Halve::Halve(const std::shared_ptr<gpu::Device>& device)
    : kernel_(device->kernel(shaders::image_halve)) {}

void Halve::record(gpu::Commands& commands, const Plane& fine, const Plane& coarse) const {
  const uint32_t push[2] = {fine.extent.width, fine.extent.height};
  commands.dispatch(kernel_, {fine.buffer, coarse.buffer}, push,
                    {coarse.extent.width, coarse.extent.height});
}

}  // namespace inverse
