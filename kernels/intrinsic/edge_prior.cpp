#include "edge_prior.hpp"

#include "../gpu/shaders.hpp"

INVERSE_SHADER(intrinsic_fold);
INVERSE_SHADER(intrinsic_prior);

namespace inverse {
namespace {
constexpr uint32_t kMostBiases = 64;  // room for FOLD_COUNT of edge_net.glsl
}

EdgePrior::EdgePrior(const std::shared_ptr<gpu::Device>& device)
    : fold_(device->kernel(shaders::intrinsic_fold, {}, kMostBiases)),
      prior_(device->kernel(shaders::intrinsic_prior)),
      biases_(gpu::Buffer::create(device, gpu::Element::vec4, kMostBiases / 4)) {}

void EdgePrior::record(gpu::Commands& commands, const Guide& guide, const Target& target,
                       const Params& params) const {
  commands.dispatch(fold_, {guide.statistics(), biases_}, {kMostBiases});
  const struct {
    uint32_t width, height;
    Params params;
  } push{guide.extent().width, guide.extent().height, params};
  commands.dispatch(prior_,
                    {guide.level0(), guide.level1(), guide.cells(), guide.values(), guide.statistics(),
                     biases_, target.system, target.flux, target.value},
                    push, line_of(quads_of(guide.extent())));
}

}  // namespace inverse
