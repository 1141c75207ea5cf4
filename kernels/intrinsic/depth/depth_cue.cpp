// SPDX-License-Identifier: LGPL-2.1-or-later
#include "depth_cue.hpp"

#include "kernels/image/pack4.hpp"

namespace inverse {

DepthCue::DepthCue(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : extent_(extent), edges_(device, {}, 4, 16) {}

void DepthCue::set(const KnownReflectance* known) {
  const bool was = known_ != nullptr;
  known_ = known && known->surface ? known : nullptr;
  changed_ = was != (known_ != nullptr);
}

void DepthCue::record_edges(gpu::Commands& commands, const Guide& guide,
                            const gpu::BufferPtr& system, const gpu::BufferPtr& flux,
                            const TileList* listed, float weight) const {
  if (!known_ || weight == 0) return;
  edges_.dispatch(
      commands, listed,
      {.surface = known_->surface,
       .depth = known_->depth,
       .valid = known_->valid,
       .level0 = guide.level0(),
       .system = system,
       .flux = flux},
      {.size = extent_, .view = known_->extent, .focal = known_->focal, .weight = weight},
      line_of(pack4_count(extent_)));
}

}  // namespace inverse
