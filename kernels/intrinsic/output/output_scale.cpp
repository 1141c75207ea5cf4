// SPDX-License-Identifier: LGPL-2.1-or-later
#include "output_scale.hpp"

#include <algorithm>

namespace inverse {

OutputScale::OutputScale(const std::shared_ptr<gpu::Device>& device, Extent cells)
    : normalization_(device, cells),
      count_(device),
      target_kernel_(device, {}, device->variant().lone_workgroup),
      counts_(gpu::Buffer::create(device, gpu::Element::word,
                                  2 * shaders::intrinsic_output_target_scale::kBrightnessBins)),
      target_(gpu::Buffer::create(device, gpu::Element::vec4, 1)) {}

void OutputScale::take(gpu::Commands& commands, const OutputScale& other) {
  normalization_.take(commands, other.normalization_);
}

void OutputScale::record(gpu::Commands& commands, const Guide& guide, const gpu::BufferPtr& shading,
                         const gpu::BufferPtr& decision, History history, const Params& params,
                         const gpu::BufferPtr& light) {
  if (!cleared_) commands.fill(counts_);
  cleared_ = true;
  commands.dispatch(count_,
                    {.cells = guide.cells(),
                     .shading = shading,
                     .counts = counts_,
                     .scale_cells = normalization_.cells(),
                     .light = normalization_.light_of(commands, light)},
                    {.size = guide.extent()}, line_of(guide.cell_extent().pixels()));
  commands.dispatch(target_kernel_, {.counts = counts_, .target = target_},
                    {.quantile = std::clamp(params.white_quantile, 0.0F, 1.0F)}, {});
  normalization_.record(
      commands, {target_, decision, history, std::clamp(params.white_level, 0.05F, 1.0F), light});
}

}  // namespace inverse
