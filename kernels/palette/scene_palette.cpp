#include "scene_palette.hpp"

#include <algorithm>

#include "kernels/gpu/shaders.hpp"

INVERSE_SHADER(palette_pick);
INVERSE_SHADER(palette_paint);

namespace inverse {
namespace {
constexpr uint64_t kSample = 20'000;  // pixels
}

ScenePalette::ScenePalette(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : palette_(device),
      pick_(device->kernel(shaders::palette_pick)),
      paint_(device->kernel(shaders::palette_paint)) {
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
  const uint32_t push[] = {sample_.extent.width, sample_.extent.height, stride_,
                           model.extent.width};
  commands.dispatch(pick_, {model.buffer, sample_.buffer}, push,
                    {sample_.extent.width, sample_.extent.height});
  palette_.record_update(commands, sample_);
}

void ScenePalette::record_paint(gpu::Commands& commands, const Plane& model,
                                const Plane& target) const {
  const struct {
    uint32_t width, height;
    int32_t clusters;
  } push{model.extent.width, model.extent.height, palette_.params().clusters};
  commands.dispatch(paint_, {model.buffer, palette_.colors(), target.buffer}, push,
                    {model.extent.width, model.extent.height});
}

}  // namespace inverse
