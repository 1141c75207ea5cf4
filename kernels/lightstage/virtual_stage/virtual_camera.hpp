// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/lightstage_virtual_stage_camera.spv.hpp"

namespace inverse {

/// Model of a virtual-stage camera: motion in the image, gain, noise.
class VirtualCamera {
 public:
  struct Shot {
    /// Displacement of the top row to the right, pixels; the bottom row does not move, rows between
    /// in proportion: the content of (x, y) moves to (x + sway (1 - y / (height - 1)), y).
    float sway = 0;
    float gain = 1;
    /// Standard deviation of the noise at white. Its variance grows with light; a tenth of it
    /// remains without light.
    float noise = 0;
    uint32_t seed = 0, frame = 0;  ///< the same values give the same noise
  };
  explicit VirtualCamera(const std::shared_ptr<gpu::Device>& device);
  /// Records the image of `light` into `picture` of the same size: rgb, w = 1; negative values from
  /// noise are kept.
  void record(gpu::Commands& commands, const Plane& light, const Shot& shot,
              const Plane& picture) const;

 private:
  gpu::Program<shaders::lightstage_virtual_stage_camera> kernel_;
};

}  // namespace inverse
