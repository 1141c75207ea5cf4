// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene_palette.hpp"

#include <algorithm>

namespace inverse {
namespace {
constexpr uint64_t kSample = 20'000;  // pixels
}

ScenePalette::ScenePalette(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : palette_(device), pick_(device), paint_(device) {
  while (extent.pixels() / stride_ / stride_ > kSample) ++stride_;
  sample_.extent = {(extent.width - 1) / stride_ + 1, (extent.height - 1) / stride_ + 1};
  sample_.buffer = gpu::Buffer::create(device, gpu::Element::vec4, sample_.extent.pixels());
}

void ScenePalette::record_update(gpu::Commands& commands, const Plane& model, int clusters) {
  clusters = std::clamp(clusters, 1, static_cast<int>(Palette::kMaxClusters));
  if (clusters != palette_.params().clusters) {
    Palette::Params params;
    params.clusters = clusters;
    palette_.set_params(params);
    palette_.reset();
  }
  commands.dispatch(pick_, {.model = model.buffer, .picked = sample_.buffer},
                    {.size = sample_.extent, .stride = stride_, .model_width = model.extent.width},
                    {sample_.extent.width, sample_.extent.height});
  palette_.record_update(commands, sample_);
}

void ScenePalette::record_paint(gpu::Commands& commands, const Plane& model,
                                const Plane& target) const {
  commands.dispatch_rows(
      paint_,
      {.model = model.buffer, .palette = palette_.colors(), .painted = gpu::by_rows(target.buffer)},
      {.size = model.extent, .clusters = palette_.params().clusters, .first_row = 0},
      {model.extent.width, model.extent.height});
}

}  // namespace inverse
