// SPDX-License-Identifier: LGPL-2.1-or-later
#include "temporal_anchor.hpp"

#include "kernels/gpu/reduce.hpp"
#include "kernels/image/pyramid.hpp"

namespace inverse {
namespace {
/// One tile a 4 x 4 cells.
constexpr uint64_t tiles_of(Extent cells) {
  return static_cast<uint64_t>(pack4_count(cells.width)) * ((cells.height + 3) / 4);
}
}  // namespace

TemporalAnchor::TemporalAnchor(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : extent_(extent),
      cells_(half_of(half_of(extent))),
      compare_(device),
      static_tiles_(device),
      decide_(device, {}, shaders::intrinsic_temporal_cut_decision::kSumLanes),
      kept_(gpu::Buffer::create(device, gpu::Element::vec4, cells_.pixels())),
      memory_(gpu::Buffer::create(device, gpu::Element::vec4, kMemoryStride * pack4_count(extent))),
      now_(gpu::Buffer::create(device, gpu::Element::vec4, kMemoryStride * pack4_count(extent))),
      mismatch_(gpu::Buffer::create(device, gpu::Element::vec4, cells_.pixels())),
      tiles_(gpu::Buffer::create(device, gpu::Element::vec4, tiles_of(cells_))),
      sums_(gpu::Buffer::create(
          device, gpu::Element::vec4,
          gpu::partial_count(*static_tiles_.kernel(), line_of(tiles_of(cells_))))),
      cut_decision_(gpu::Buffer::create(device, gpu::Element::vec4,
                                        shaders::intrinsic_temporal_cut_decision::CUT_STRIDE)) {}

void TemporalAnchor::record(gpu::Commands& commands, const Guide& guide, const Params& params,
                            bool continues) {
  if (!cleared_) commands.fill(sums_);
  cleared_ = true;
  commands.dispatch(compare_,
                    {.cells = guide.cells(),
                     .guide_coarse = guide.guide_coarse(),
                     .level0 = guide.level0(),
                     .before = kept_,
                     .memory = memory_,
                     .mismatch = mismatch_},
                    {.size = extent_,
                     .detail = 1 / params.anchor_detail,
                     .chroma = 1 / params.anchor_chroma,
                     .texture = 1 / params.anchor_texture},
                    line_of(cells_.pixels()));
  commands.dispatch(static_tiles_, {.mismatch = mismatch_, .tiles = tiles_, .sums = sums_},
                    {.size = cells_}, line_of(tiles_of(cells_)));
  commands.dispatch(decide_, {.sums = sums_, .cut_decision = cut_decision_},
                    {.count = static_cast<uint32_t>(sums_->count()),
                     .cells = static_cast<float>(cells_.pixels()),
                     .cut_fraction = params.cut_fraction,
                     .continues = continues ? 1.0F : 0.0F},
                    {});
}

}  // namespace inverse
