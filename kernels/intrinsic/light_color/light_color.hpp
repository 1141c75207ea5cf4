// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <optional>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/intrinsic_light_color_points.spv.hpp"
#include "kernels/intrinsic_light_color_scene.spv.hpp"
#include "kernels/intrinsic_light_color_white.spv.hpp"

namespace inverse {

/// The color of a scene's light, one number: its slope (image/light_color.glsl;
/// docs/reference/methods/intrinsicdecomp.md, 2), and where light is white. All of it is on the
/// device.
class LightColor {
 public:
  static constexpr float kMaxSlope = 2;
  struct Params {
    /// Step of ln R/B of light with a step of its ln brightness, −kMaxSlope…kMaxSlope; 0: gray
    /// light; empty: found in the frames.
    std::optional<float> slope = 0.0F;
    bool colored() const { return slope != 0.0F; }
    bool operator==(const Params&) const = default;
  };

  /// `extent` of frames.
  LightColor(const std::shared_ptr<gpu::Device>& device, Extent extent);
  /// Records measuring a frame, linear RGB. `first`: it has no relation to the frame before.
  void record(gpu::Commands& commands, const gpu::BufferPtr& frame, const Params& params,
              bool first);
  /// Of the frame recorded last, for the guide (light.glsl).
  const gpu::BufferPtr& state() const { return light_; }
  /// What the layers of that frame carry, one vec4 (Role::slope). `scale`:
  /// ScaleNormalization::value of the layers.
  PlanePtr record_slope(gpu::Commands& commands, const gpu::BufferPtr& scale);

 private:
  Extent extent_, cells_;
  uint32_t factor_;  // pixels along a cell
  gpu::Program<shaders::intrinsic_light_color_points> points_kernel_;
  gpu::Program<shaders::intrinsic_light_color_scene> scene_;
  gpu::Program<shaders::intrinsic_light_color_white> white_;
  gpu::BufferPtr points_, light_;
  PlanePool slopes_;
};

}  // namespace inverse
