// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>

#include "gaussians.hpp"
#include "kernels/edit_stylize_apply.spv.hpp"
#include "kernels/edit_stylize_flatten.spv.hpp"
#include "kernels/image/layers.hpp"

namespace inverse {

/// How a frame is drawn.
struct StylizeParams {
  /// Sigma of the Gaussian that lines and levels are made with, pixels: the size of what counts as
  /// detail.
  float scale = 1.4F;
  /// 1 / height of the smallest step of log shading that gets a line, 1 / stops; 0: no lines.
  float sensitivity = 1.5F;
  /// How fast lines become black beyond that.
  float sharpness = 2;
  /// Steps of shading between black and 1, evenly spaced in log shading; 0: shading stays smooth.
  float levels = 5;
  /// Share of the way from one level to the next that is gradual; 0: hard steps.
  float softness = .3F;
  /// Difference of ln reflectance that is smoothed away; 0: reflectance stays.
  float flatten = .2F;
  /// 0: nothing changes; 1: the frame is fully drawn.
  float strength = 1;
  /// Multiply the strength by the mask layer if there is one.
  bool use_mask = true;

  static constexpr float kMinScale = .3F, kMaxScale = 100, kMaxLevels = 64;
};

/// Draws a frame (thesis 3.7.4, after Winnemöller et al. 2006 and 2012): lines by a difference of
/// Gaussians of log shading, shading in levels, flat reflectance. As lines are of shading, paint
/// has no outlines.
class Stylize {
 public:
  Stylize(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Records the edit of `layers`, which must have Role::intrinsic. Planes that others hold are not
  /// written. Does nothing if strength is 0, or sensitivity, levels and flatten all are. Values
  /// that are not finite count as 0 (infinity: as 65504); `params` are clamped to their ranges.
  void record(gpu::Commands& commands, Layers& layers, const StylizeParams& params);

 private:
  PlanePtr flatten(gpu::Commands& commands, const Plane& intrinsic, float sigma, float difference);

  std::shared_ptr<gpu::Device> device_;
  PlanePool planes_;
  gpu::BufferPtr nothing_;
  Gaussians gaussians_;
  // By MATTE + 2 SHADES + 4 FLATTENED.
  std::array<gpu::Program<shaders::edit_stylize_apply>, 8> apply_;
  std::array<gpu::Program<shaders::edit_stylize_flatten>, 2> flatten_;
};

}  // namespace inverse
