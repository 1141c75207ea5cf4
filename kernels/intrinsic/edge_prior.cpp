#include "edge_prior.hpp"

#include "../gpu/shaders.hpp"
#include "multigrid.hpp"

INVERSE_SHADER(intrinsic_edge_prior);

namespace inverse {
namespace {
constexpr uint32_t kRows = 4;
}

EdgePrior::EdgePrior(const std::shared_ptr<gpu::Device>& device)
    : kernel_(device->kernel(shaders::intrinsic_edge_prior, {kRows})) {}

void EdgePrior::record(gpu::Commands& commands, const Guide& guide, const Edges& edges,
                       const Params& params) const {
  const struct {
    uint32_t width, height;
    float sparsity, smoothness, alpha, beta;
  } push{guide.extent.width, guide.extent.height, params.sparsity,
         params.smoothness,  params.alpha,        params.beta};
  commands.dispatch(kernel_, {guide.chroma0, guide.chroma1, edges.right, edges.down}, push,
                    {quads_of(guide.extent.width) * ((guide.extent.height + kRows - 1) / kRows)});
}

}  // namespace inverse
