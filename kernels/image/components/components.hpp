// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/image_components_join.spv.hpp"
#include "kernels/image_components_start.spv.hpp"

namespace inverse {

/// Connected components of a picture's labels (components.glsl).
class Components {
 public:
  Components(const std::shared_ptr<gpu::Device>& device, Extent extent)
      : extent_(extent), start_(device), join_(device) {}

  /// Finds the components of pixels whose label, w in `labels`, is the same and at least 0.
  void record(gpu::Commands& commands, const gpu::BufferPtr& labels) {
    if (!roots_)
      roots_ = gpu::Buffer::create(commands.device(), gpu::Element::word, extent_.pixels());
    const gpu::Items pixels{extent_.width, extent_.height};
    commands.dispatch(start_, {.roots = roots_}, {.size = extent_}, pixels);
    commands.dispatch(join_, {.labels = labels, .roots = roots_}, {.size = extent_}, pixels);
  }
  /// A word a pixel, for `root_of`; null before the first `record`.
  const gpu::BufferPtr& roots() const { return roots_; }

 private:
  Extent extent_;
  gpu::Program<shaders::image_components_start> start_;
  gpu::Program<shaders::image_components_join> join_;
  gpu::BufferPtr roots_;
};

}  // namespace inverse
