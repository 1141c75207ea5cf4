// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "kernels/gpu/commands.hpp"
#include "kernels/image_halve.spv.hpp"
#include "plane.hpp"

namespace inverse {

/// Size of the next coarser pyramid level: half, rounded up.
constexpr Extent half_of(Extent fine) { return {(fine.width + 1) / 2, (fine.height + 1) / 2}; }

/// Halves a plane: each coarse pixel is the mean of its up to four fine pixels.
class Halve {
 public:
  explicit Halve(const std::shared_ptr<gpu::Device>& device);
  /// `coarse.extent` must be half_of(fine.extent).
  void record(gpu::Commands& commands, const Plane& fine, const Plane& coarse) const;

 private:
  gpu::Program<shaders::image_halve> kernel_;
};

}  // namespace inverse
