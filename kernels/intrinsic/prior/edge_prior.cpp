#include "edge_prior.hpp"

#include <array>

#include "kernels/gpu/shaders.hpp"
#include "kernels/image/pyramid.hpp"

INVERSE_SHADER(intrinsic_prior_fold);
INVERSE_SHADER(intrinsic_prior_edges);
INVERSE_SHADER(intrinsic_prior_cell_values);
INVERSE_SHADER(intrinsic_prior_change);
INVERSE_SHADER(intrinsic_prior_keep);

namespace inverse {
namespace {

constexpr uint32_t kMostBiases = 16;  // vec4: room for FOLD_VECTORS of edge_net.glsl

struct Push {
  uint32_t width, height;
  float first, second;
};

}  // namespace

EdgePrior::EdgePrior(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : fold_(device->kernel(shaders::intrinsic_prior_fold)),
      change_(device->kernel(shaders::intrinsic_prior_change)),
      edges_{TileKernel(device, shaders::intrinsic_prior_edges, {0}, 4, 4),
             TileKernel(device, shaders::intrinsic_prior_edges, {1}, 4, 4)},
      values_(device, shaders::intrinsic_prior_cell_values, {}, 1, 4),
      keep_(device, shaders::intrinsic_prior_keep, {}, 8, 8),
      changes_(device, extent),
      biases_(gpu::Buffer::create(device, gpu::Element::vec4, kMostBiases)),
      kept_(gpu::Buffer::create(device, gpu::Element::vec4, half_of(extent).pixels())),
      kept_statistics_(gpu::Buffer::create(device, gpu::Element::vec4, 2)) {}

void EdgePrior::record_edges(gpu::Commands& commands, const Guide& guide, const Target& target,
                             const Params& params, const TileList* listed) const {
  const Extent extent = guide.extent();
  for (const TileKernel& edges : edges_)
    edges.dispatch(
        commands, listed,
        {guide.level0(), guide.level1(), guide.cells(), guide.statistics(), biases_, target.system,
         target.flux},
        Push{extent.width, extent.height, params.reflectance_weight, params.shading_weight},
        line_of(static_cast<uint64_t>(quads_of(extent.width)) * ((extent.height + 3) / 4)));
}

void EdgePrior::record_values(gpu::Commands& commands, const Guide& guide, const Target& target,
                              const Params& params, const TileList* listed) const {
  const Extent cells = guide.cell_extent();
  values_.dispatch(commands, listed,
                   {guide.cells(), guide.wide(), guide.statistics(), biases_, target.value},
                   Push{cells.width, cells.height, params.value_weight, params.chroma_weight},
                   line_of(quads_of(cells)));
}

void EdgePrior::record_keep(gpu::Commands& commands, const Guide& guide,
                            const TileList& listed) const {
  const Extent level1 = guide.extent1();
  const std::array<uint32_t, 3> push{level1.width, level1.height, tiles()};
  keep_.dispatch(commands, &listed, {guide.level1(), guide.statistics(), kept_, kept_statistics_},
                 push, {});
}

void EdgePrior::record(gpu::Commands& commands, const Guide& guide, const Target& target,
                       const Params& params, bool keep) {
  known_ = keep;
  known_params_ = params;
  known_system_ = target.system;
  if (keep) {
    commands.copy(guide.level1(), kept_, kept_->bytes());
    commands.copy(guide.statistics(), kept_statistics_, kept_statistics_->bytes());
  }
  commands.dispatch(fold_, {guide.statistics(), biases_}, {});
  record_edges(commands, guide, target, params, nullptr);
  record_values(commands, guide, target, params, nullptr);
}

void EdgePrior::record_changes(gpu::Commands& commands, const Guide& guide, const Target& target,
                               const Params& params, float tolerance) {
  Params edges = params;
  edges.chroma_weight =
      known_params_.chroma_weight;  // and value_weight: of cells, made anew always
  edges.value_weight = known_params_.value_weight;
  const bool all = !known_ || known_params_ != edges || known_system_ != target.system;
  const Extent level1 = guide.extent1();
  const struct {
    uint32_t width, height;
    float tolerance;
    uint32_t all;
  } change{level1.width, level1.height, tolerance, all ? 1U : 0U};
  commands.dispatch(change_,
                    {guide.level1(), kept_, guide.statistics(), kept_statistics_, changes_.flags()},
                    change, line_of(tiles()));
  changes_.record(commands);
  commands.dispatch(fold_, {guide.statistics(), biases_}, {});
  record_edges(commands, guide, target, params, &changes_);
  record_keep(commands, guide, changes_);
  record_values(commands, guide, target, params, nullptr);
  known_ = true;
  known_params_ = params;
  known_system_ = target.system;
}

void EdgePrior::record_tiles(gpu::Commands& commands, const Guide& guide, const Target& target,
                             const Params& params, const TileList& listed) const {
  commands.dispatch(fold_, {guide.statistics(), biases_}, {});
  record_edges(commands, guide, target, params, &listed);
  record_keep(commands, guide, listed);
  record_values(commands, guide, target, params, &listed);
}

}  // namespace inverse
