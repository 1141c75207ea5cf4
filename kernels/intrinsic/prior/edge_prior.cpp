// SPDX-License-Identifier: LGPL-2.1-or-later
#include "edge_prior.hpp"

#include "kernels/image/pyramid.hpp"

namespace inverse {
EdgePrior::EdgePrior(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device),
      extent_(extent),
      fold_biases_(device),
      change_(device, {}, device->variant().area_workgroup()),
      edges_{{device, {.down = false}, 4, 4}, {device, {.down = true}, 4, 4}},
      values_(device),
      save_reference_(device, {}, 8, 8),
      changes_(device, extent),
      same_(gpu::make_table(device, gpu::Element::word, std::vector<uint32_t>{0})),
      biases_(gpu::Buffer::create(device, gpu::Element::vec4,
                                  shaders::intrinsic_prior_fold_biases::FOLD_VECTORS)),
      kept_(gpu::Buffer::create(device, gpu::Element::vec4, half_of(extent).pixels())),
      kept_statistics_(gpu::Buffer::create(device, gpu::Element::vec4, Guide::kStatisticsSize)) {}

EdgePrior::Learned::Learned(const std::shared_ptr<gpu::Device>& device, Extent extent,
                            const PriorModelPtr& model)
    : network(device, extent, model), values(device, {.learned = true}) {}

void EdgePrior::prepare(const PriorModelPtr& network) {
  if (!network)
    learned_.reset();
  else if (!learned_ || learned_->network.model() != network)
    learned_.emplace(device_, extent_, network);
}

void EdgePrior::record_frame(gpu::Commands& commands, const Guide& guide, const Params& params,
                             const TileList* listed) {
  prepare(params.network);
  commands.dispatch(fold_biases_, {.statistics = guide.statistics(), .biases = biases_}, {});
  if (!learned_) return;
  learned_->network.record(commands, guide, params.network_interval, listed);
  commands.stage("prior-network");
}

void EdgePrior::record_edges(gpu::Commands& commands, const Guide& guide, const Target& target,
                             const Params& params, const TileList* listed) const {
  const Extent extent = guide.extent();
  for (const Edges& edges : edges_)
    edges.dispatch(
        commands, listed,
        {.level0 = guide.level0(),
         .level1 = guide.level1(),
         .cells = guide.cells(),
         .statistics = guide.statistics(),
         .tuning = biases_,
         .system = target.system,
         .flux = target.flux},
        {.size = extent,
         .reflectance_weight = params.reflectance_weight,
         .shading_weight = params.shading_weight},
        line_of(static_cast<uint64_t>(pack4_count(extent.width)) * ((extent.height + 3) / 4)));
  if (target.depth)
    target.depth->record_edges(commands, guide, target.system, target.flux, listed,
                               params.depth_weight);
  if (target.strokes)
    target.strokes->record_edges(commands, guide, target.system, target.flux, listed);
}

void EdgePrior::record_values(gpu::Commands& commands, const Guide& guide, const Target& target,
                              const Params& params) const {
  const Extent cells = guide.cell_extent();
  const PriorPicture* picture = learned_ ? &learned_->network.picture() : nullptr;
  commands.dispatch(learned_ ? learned_->values : values_,
                    {.cells = guide.cells(),
                     .guide_coarse = guide.guide_coarse(),
                     .statistics = guide.statistics(),
                     .tuning = biases_,
                     .fields = learned_ ? learned_->network.fields() : biases_,
                     .value = target.value},
                    {.size = cells,
                     .value_weight = params.value_weight,
                     .chroma_weight = params.chroma_weight,
                     .network_size = picture ? picture->extent : Extent{},
                     .network_level = picture ? static_cast<int32_t>(picture->level) : 0},
                    line_of(pack4_count(cells)));
  if (target.strokes) target.strokes->record_values(commands, guide, target.value);
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
  record_frame(commands, guide, params, nullptr);
  record_edges(commands, guide, target, params, nullptr);
  record_values(commands, guide, target, params);
}

void EdgePrior::record_changes(gpu::Commands& commands, const Guide& guide, const Target& target,
                               const Params& params, float tolerance) {
  Params edges = params;
  edges.chroma_weight =
      known_params_.chroma_weight;  // and value_weight: of cells, which are always evaluated
  edges.value_weight = known_params_.value_weight;
  const bool all = !known_ || known_params_ != edges || known_system_ != target.system;
  const bool seen = target.depth && params.depth_weight != 0;
  commands.dispatch(change_,
                    {.level1 = guide.level1(),
                     .kept = kept_,
                     .statistics = guide.statistics(),
                     .kept_statistics = kept_statistics_,
                     .outdated = seen ? target.depth->outdated() : same_,
                     .flags = changes_.flags()},
                    {.size = guide.extent1(), .tolerance = tolerance, .all = all},
                    line_of(uint64_t{tiles()} * change_.kernel()->workgroup()));
  if (target.strokes) changes_.record_merge(commands, target.strokes->changed());
  changes_.record(commands);
  record_frame(commands, guide, params, &changes_);
  record_edges(commands, guide, target, params, &changes_);
  save_reference_.dispatch(commands, &changes_,
                           {.level1 = guide.level1(),
                            .statistics = guide.statistics(),
                            .kept = kept_,
                            .kept_statistics = kept_statistics_},
                           {.size = guide.extent1(), .tiles = tiles()}, {});
  record_values(commands, guide, target, params);
  known_ = true;
  known_params_ = params;
  known_system_ = target.system;
}

}  // namespace inverse
