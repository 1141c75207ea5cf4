#include "edge_prior.hpp"

#include "../gpu/shaders.hpp"

INVERSE_SHADER(intrinsic_fold);
INVERSE_SHADER(intrinsic_edges);
INVERSE_SHADER(intrinsic_cell_values);

namespace inverse {
namespace {
constexpr uint32_t kMostBiases = 16;  // vec4: room for FOLD_VECTORS of edge_net.glsl
}

EdgePrior::EdgePrior(const std::shared_ptr<gpu::Device>& device)
    : fold_(device->kernel(shaders::intrinsic_fold)),
      edges_(device->kernel(shaders::intrinsic_edges)),
      values_(device->kernel(shaders::intrinsic_cell_values)),
      biases_(gpu::Buffer::create(device, gpu::Element::vec4, kMostBiases)) {}

void EdgePrior::record(gpu::Commands& commands, const Guide& guide, const Target& target,
                       const Params& params) const {
  struct Push {
    uint32_t width, height;
    float first, second;
  };
  commands.dispatch(fold_, {guide.statistics(), biases_}, {});
  const Extent extent = guide.extent(), cells = guide.cell_extent();
  commands.dispatch(
      edges_,
      {guide.level0(), guide.level1(), guide.cells(), guide.statistics(), biases_, target.system,
       target.flux},
      Push{extent.width, extent.height, params.reflectance_weight, params.shading_weight},
      line_of(static_cast<uint64_t>(quads_of(extent.width)) * ((extent.height + 1) / 2)));
  commands.dispatch(values_,
                    {guide.cells(), guide.wide(), guide.statistics(), biases_, target.value},
                    Push{cells.width, cells.height, params.value_weight, params.chroma_weight},
                    line_of(quads_of(cells)));
}

}  // namespace inverse
