// SPDX-License-Identifier: LGPL-2.1-or-later
#include "virtual_camera.hpp"

namespace inverse {

VirtualCamera::VirtualCamera(const std::shared_ptr<gpu::Device>& device) : kernel_(device) {}

void VirtualCamera::record(gpu::Commands& commands, const Plane& light, const Shot& shot,
                           const Plane& picture) const {
  commands.dispatch(kernel_, {.light = light.buffer, .picture = picture.buffer},
                    {.width = light.extent.width,
                     .height = light.extent.height,
                     .sway = shot.sway,
                     .gain = shot.gain,
                     .noise = shot.noise,
                     .seed = shot.seed,
                     .frame = shot.frame},
                    {static_cast<uint32_t>(light.extent.pixels())});
}

}  // namespace inverse
