#include "edge_prior.hpp"

#include <array>

#include "../gpu/shaders.hpp"
#include "../image/pyramid.hpp"

INVERSE_SHADER(intrinsic_fold);
INVERSE_SHADER(intrinsic_edges);
INVERSE_SHADER(intrinsic_cell_values);
INVERSE_SHADER(intrinsic_change);
INVERSE_SHADER(intrinsic_launch);
INVERSE_SHADER(intrinsic_keep);

namespace inverse {
namespace {

constexpr uint32_t kMostBiases = 16;  // vec4: room for FOLD_VECTORS of edge_net.glsl
constexpr uint32_t kTile = 16;        // pixels, as in tiles.glsl
constexpr uint64_t kEdgeArguments = 4, kKeepArguments = 16;  // bytes into the control buffer
constexpr uint32_t kControlWords = 8;

struct Push {
  uint32_t width, height;
  float first, second;
};

}  // namespace

EdgePrior::EdgePrior(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : fold_(device->kernel(shaders::intrinsic_fold)),
      edges_{device->kernel(shaders::intrinsic_edges, {0, 0}),
             device->kernel(shaders::intrinsic_edges, {1, 0})},
      listed_edges_{device->kernel(shaders::intrinsic_edges, {0, 1}),
                    device->kernel(shaders::intrinsic_edges, {1, 1})},
      values_(device->kernel(shaders::intrinsic_cell_values)),
      change_(device->kernel(shaders::intrinsic_change)),
      launch_(device->kernel(shaders::intrinsic_launch)),
      keep_(device->kernel(shaders::intrinsic_keep)),
      tiles_(((extent.width + kTile - 1) / kTile) * ((extent.height + kTile - 1) / kTile)),
      biases_(gpu::Buffer::create(device, gpu::Element::vec4, kMostBiases)),
      control_(gpu::Buffer::create(device, gpu::Element::word, kControlWords)),
      list_(gpu::Buffer::create(device, gpu::Element::word, tiles_)),
      kept_(gpu::Buffer::create(device, gpu::Element::vec4, half_of(extent).pixels())),
      kept_statistics_(gpu::Buffer::create(device, gpu::Element::vec4, 2)) {}

void EdgePrior::record_edges(gpu::Commands& commands, const Guide& guide, const Target& target,
                             const Params& params, bool listed) const {
  const Extent extent = guide.extent();
  const Push push{extent.width, extent.height, params.reflectance_weight, params.shading_weight};
  const std::array<gpu::BufferPtr, 9> buffers{
      guide.level0(), guide.level1(), guide.cells(), guide.statistics(), biases_,
      control_,       list_,          target.system, target.flux};
  const auto bytes = std::as_bytes(std::span(&push, 1));
  for (const int direction : {0, 1})
    if (listed)
      commands.dispatch_indirect(listed_edges_[direction], buffers, bytes, control_,
                                 kEdgeArguments);
    else
      commands.dispatch(
          edges_[direction], buffers, bytes,
          line_of(static_cast<uint64_t>(quads_of(extent.width)) * ((extent.height + 3) / 4)));
}

void EdgePrior::record_values(gpu::Commands& commands, const Guide& guide, const Target& target,
                              const Params& params) const {
  const Extent cells = guide.cell_extent();
  commands.dispatch(values_,
                    {guide.cells(), guide.wide(), guide.statistics(), biases_, target.value},
                    Push{cells.width, cells.height, params.value_weight, params.chroma_weight},
                    line_of(quads_of(cells)));
}

void EdgePrior::record(gpu::Commands& commands, const Guide& guide, const Target& target,
                       const Params& params) {
  reset();
  commands.dispatch(fold_, {guide.statistics(), biases_}, {});
  record_edges(commands, guide, target, params, false);
  record_values(commands, guide, target, params);
}

void EdgePrior::record_changes(gpu::Commands& commands, const Guide& guide, const Target& target,
                               const Params& params, float tolerance) {
  Params edges = params;
  edges.chroma_weight =
      known_params_.chroma_weight;  // and value_weight: of cells, made anew always
  edges.value_weight = known_params_.value_weight;
  const bool all = !known_ || known_params_ != edges || known_system_ != target.system;
  const Extent level1 = guide.extent1();
  commands.fill(control_);
  const struct {
    uint32_t width, height;
    float tolerance;
    uint32_t all;
  } change{level1.width, level1.height, tolerance, all ? 1U : 0U};
  commands.dispatch(change_,
                    {guide.level1(), kept_, guide.statistics(), kept_statistics_, control_, list_},
                    change, line_of(tiles_));
  const std::array<uint32_t, 2> launch{tiles_, listed_edges_[0]->workgroup()};
  commands.dispatch(launch_, {guide.statistics(), control_, kept_statistics_}, launch, {});
  commands.dispatch(fold_, {guide.statistics(), biases_}, {});
  record_edges(commands, guide, target, params, true);
  const std::array<uint32_t, 2> size{level1.width, level1.height};
  const std::array<gpu::BufferPtr, 4> keep{guide.level1(), control_, list_, kept_};
  commands.dispatch_indirect(keep_, keep, std::as_bytes(std::span(size)), control_, kKeepArguments);
  record_values(commands, guide, target, params);
  known_ = true;
  known_params_ = params;
  known_system_ = target.system;
}

}  // namespace inverse
