// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <span>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/texture_luminance.spv.hpp"

namespace inverse {

/// The luminance of frames at reduced size, for the host: what follows a plane looks at it.
class PlaneLuminance {
 public:
  PlaneLuminance(const std::shared_ptr<gpu::Device>& device, Extent frame);
  /// Width and height of the frame per pixel: the smallest factor by which neither side exceeds
  /// kMaxSide.
  uint32_t factor() const { return factor_; }
  Extent size() const { return size_; }
  static constexpr uint32_t kMaxSide = 960;

  /// Records the reduction of `frame`, linear RGB.
  void record(gpu::Commands& commands, const Plane& frame);
  /// What was recorded last, when that is done: rows of values 0…1 (luminance.comp).
  std::span<const float> values() const;

 private:
  Extent frame_;
  uint32_t factor_;
  Extent size_;
  gpu::Program<shaders::texture_luminance> reduce_;
  gpu::BufferPtr values_;
};

}  // namespace inverse
