// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/texture_level.spv.hpp"

namespace inverse {

/// A picture on the device at all sizes from its own down to 1 × 1, each half of the one before,
/// rounded up: level.comp.
class TexturePyramid {
 public:
  TexturePyramid(const std::shared_ptr<gpu::Device>& device, Extent picture);
  /// Records making it of `picture`: linear RGB and alpha, of this size.
  void record(gpu::Commands& commands, const Plane& picture);

  Extent extent() const { return extent_; }
  uint32_t levels() const { return levels_; }
  /// The levels, one behind the other; colors are multiplied by alpha.
  const gpu::BufferPtr& buffer() const { return buffer_; }

 private:
  Extent extent_;
  gpu::Program<shaders::texture_level> base_, level_;
  uint32_t levels_ = 1;
  gpu::BufferPtr buffer_;
};

}  // namespace inverse
