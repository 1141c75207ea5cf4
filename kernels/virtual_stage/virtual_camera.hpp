#pragma once
#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/virtual_stage_camera.spv.hpp"

namespace inverse {

/// What a camera of the virtual stage makes of light: motion in the picture, gain, noise.
class VirtualCamera {
 public:
  struct Shot {
    /// The top row moves so many pixels to the right, the bottom row not at all, those between in
    /// proportion: what was at (x, y) is at (x + sway (1 - y / (height - 1)), y).
    float sway = 0;
    float gain = 1;
    /// Standard deviation of the noise at white; its square grows with light, a tenth of it is
    /// there without.
    float noise = 0;
    uint32_t seed = 0, frame = 0;  ///< the same numbers give the same noise
  };
  explicit VirtualCamera(const std::shared_ptr<gpu::Device>& device);
  /// Records the picture of `light` into `picture` of the same size: rgb, w 1; negative where noise
  /// is.
  void record(gpu::Commands& commands, const Plane& light, const Shot& shot,
              const Plane& picture) const;

 private:
  gpu::Program<shaders::virtual_stage_camera> kernel_;
};

}  // namespace inverse
