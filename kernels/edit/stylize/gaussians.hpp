// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "kernels/edit_stylize_blur.spv.hpp"
#include "kernels/edit_stylize_reduce.spv.hpp"
#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"

namespace inverse {

/// Two blurred copies of log shading, by Gaussians of sigma and kRatio sigma, on a grid that is as
/// coarse as sigma allows: the cost a pixel does not grow with sigma.
class Gaussians {
 public:
  static constexpr float kRatio = 1.6F;

  /// How a Gaussian of `sigma` pixels is made: cells of `factor` pixels are blurred by
  /// `cell_sigma` cells. Of the variance, the cells and the interpolation between them have their
  /// part.
  struct Grid {
    uint32_t factor;
    float cell_sigma, wide_cell_sigma;
    int radius;  ///< of the kernels, cells
  };
  static Grid grid_of(float sigma);

  Gaussians(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Records E(S) of a plane (R.rgb, S) (stylize.glsl), blurred; `sigma` at least kMinSigma.
  void record(gpu::Commands& commands, const Plane& intrinsic, float sigma);

  const gpu::BufferPtr& near() const { return near_; }
  const gpu::BufferPtr& wide() const { return wide_; }
  Extent cells() const { return cells_; }
  uint32_t factor() const { return factor_; }

 private:
  void resize(uint32_t factor);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_, cells_;
  uint32_t factor_ = 0;
  gpu::BufferPtr near_, wide_, near_half_, wide_half_;  // scalars; half: blurred along rows
  gpu::BufferPtr weights_;
  gpu::Program<shaders::edit_stylize_reduce> reduce_;
  gpu::Program<shaders::edit_stylize_blur> along_rows_, along_columns_;
};

}  // namespace inverse
