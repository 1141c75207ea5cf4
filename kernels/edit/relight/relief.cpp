// SPDX-License-Identifier: LGPL-2.1-or-later
#include "relief.hpp"

#include <algorithm>

#include "kernels/image/pyramid.hpp"

namespace inverse {

Relief::Relief(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : extent_(extent),
      factor_((std::max(extent.width, extent.height) - 1) / kMaxCells + 1),
      nothing_(gpu::Buffer::create(device, gpu::Element::vec4, 1)),
      cells_(device),
      halve_(device),
      slopes_(device, {.coarsest = false}),
      coarsest_(device, {.coarsest = true}) {
  Extent cells{(extent.width - 1) / factor_ + 1, (extent.height - 1) / factor_ + 1};
  for (bool more = true; more; cells = half_of(cells)) {
    levels_.push_back({cells, gpu::Buffer::create(device, gpu::Element::scalar, cells.pixels()),
                       gpu::Buffer::create(device, gpu::Element::vec4, cells.pixels())});
    more = std::max(cells.width, cells.height) > kMinCells;
  }
}

void Relief::record(gpu::Commands& commands, const Plane& intrinsic) {
  const Level& finest = levels_.front();
  commands.dispatch(
      cells_, {.intrinsic = intrinsic.buffer, .cells = finest.heights},
      {.size = finest.extent, .frame = extent_, .factor = factor_, .fresh = fresh_ ? 1U : 0U},
      {finest.extent.width, finest.extent.height});
  fresh_ = false;
  for (size_t l = 1; l < levels_.size(); ++l)
    commands.dispatch(halve_, {.fine = levels_[l - 1].heights, .coarse = levels_[l].heights},
                      {.size = levels_[l].extent, .fine_size = levels_[l - 1].extent},
                      {levels_[l].extent.width, levels_[l].extent.height});
  for (size_t l = levels_.size(); l-- > 0;) {
    const bool coarsest = l + 1 == levels_.size();
    const Level& level = levels_[l];
    commands.dispatch(coarsest ? coarsest_ : slopes_,
                      {.heights = level.heights,
                       .coarser = coarsest ? nothing_ : levels_[l + 1].slopes,
                       .slopes = level.slopes},
                      {.size = level.extent,
                       .coarse_size = coarsest ? Extent{1, 1} : levels_[l + 1].extent,
                       .finest = l == 0 ? 1U : 0U},
                      {level.extent.width, level.extent.height});
  }
}

}  // namespace inverse
