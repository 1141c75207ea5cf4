#include "virtual_camera.hpp"

#include "kernels/gpu/shaders.hpp"

INVERSE_SHADER(virtual_stage_camera);

namespace inverse {

VirtualCamera::VirtualCamera(const std::shared_ptr<gpu::Device>& device)
    : kernel_(device->kernel(shaders::virtual_stage_camera)) {}

void VirtualCamera::record(gpu::Commands& commands, const Plane& light, const Shot& shot,
                           const Plane& picture) const {
  const struct {
    uint32_t width, height;
    float sway, gain, noise;
    uint32_t seed, frame;
  } push{light.extent.width, light.extent.height, shot.sway, shot.gain,
         shot.noise,         shot.seed,           shot.frame};
  commands.dispatch(kernel_, {light.buffer, picture.buffer}, push,
                    {static_cast<uint32_t>(light.extent.pixels())});
}

}  // namespace inverse
