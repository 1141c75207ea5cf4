// SPDX-License-Identifier: LGPL-2.1-or-later
#include "depth_cue.hpp"

#include <utility>

#include "kernels/image/pack4.hpp"

namespace inverse {

DepthCue::DepthCue(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device), extent_(extent), surfaces_(device), edges_(device, {}, 4, 16) {}

void DepthCue::set(const KnownReflectance* known, bool continues) {
  const bool was = known_ != nullptr;
  known_ = known && known->surface ? known : nullptr;
  changed_ = was != (known_ != nullptr);
  recorded_before_ = std::exchange(recorded_, false) && continues;
}

void DepthCue::record_surfaces(gpu::Commands& commands) {
  if (std::exchange(recorded_, true)) return;
  const uint64_t pixels = known_->extent.pixels();
  if (!factors_ || factors_->count() != 2 * pixels) {
    factors_ = gpu::Buffer::create(device_, gpu::Element::scalar, 2 * pixels);
    recorded_before_ = false;
  }
  const auto find = [&] {
    commands.dispatch(surfaces_, {.surface = known_->surface, .factors = factors_},
                      {.size = known_->extent, .focal = known_->focal},
                      static_cast<uint32_t>(pixels));
  };
  if (recorded_before_ && known_->outdated)
    commands.when(known_->outdated, 0, find);
  else
    find();
}

void DepthCue::record_edges(gpu::Commands& commands, const Guide& guide,
                            const gpu::BufferPtr& system, const gpu::BufferPtr& flux,
                            const TileList* listed, float weight) {
  if (!known_ || weight == 0) return;
  record_surfaces(commands);
  edges_.dispatch(commands, listed,
                  {.factors = factors_,
                   .known_depth = known_->known_depth,
                   .depth = known_->depth,
                   .valid = known_->valid,
                   .level0 = guide.level0(),
                   .system = system,
                   .flux = flux},
                  {.size = extent_, .view = known_->extent, .weight = weight},
                  line_of(pack4_count(extent_)));
}

}  // namespace inverse
