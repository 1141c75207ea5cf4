// SPDX-License-Identifier: LGPL-2.1-or-later
#include "recall.hpp"

#include "kernels/image/pack4.hpp"
#include "kernels/intrinsic/prior/edge_prior.hpp"

namespace inverse {

Recall::Recall(const std::shared_ptr<gpu::Device>& device, Extent cells)
    : recall_(device),
      value_(gpu::Buffer::create(device, gpu::Element::vec4,
                                 pack4_count(cells) * EdgePrior::kValueStride)) {}

const gpu::BufferPtr& Recall::record(gpu::Commands& commands, const Guide& guide,
                                     const gpu::BufferPtr& value, const gpu::BufferPtr& scale,
                                     const KnownReflectance& known) {
  commands.dispatch(recall_,
                    {.value = value,
                     .cells = guide.cells(),
                     .scale = scale,
                     .reflectance = known.reflectance,
                     .known_depth = known.known_depth,
                     .depth = known.depth,
                     .valid = known.valid,
                     .known_value = value_},
                    {.size = guide.cell_extent(),
                     .frame = guide.extent(),
                     .known = known.extent,
                     .weight = known.weight},
                    line_of(pack4_count(guide.cell_extent())));
  commands.stage("recall");
  return value_;
}

}  // namespace inverse
