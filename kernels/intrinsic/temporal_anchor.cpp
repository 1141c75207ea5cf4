#include "temporal_anchor.hpp"

#include "../gpu/reduce.hpp"
#include "../gpu/shaders.hpp"

INVERSE_SHADER(intrinsic_mismatch);
INVERSE_SHADER(intrinsic_verdict);

namespace inverse {
namespace {
constexpr uint32_t kSumLanes = 64;  // of verdict.comp
/// One tile a 4 x 4 cells.
constexpr uint64_t tiles_of(Extent cells) {
  return static_cast<uint64_t>(quads_of(cells.width)) * ((cells.height + 3) / 4);
}
}  // namespace

TemporalAnchor::TemporalAnchor(const std::shared_ptr<gpu::Device>& device, Extent cells)
    : cells_(cells),
      mismatch_(device->kernel(shaders::intrinsic_mismatch)),
      decide_(device->kernel(shaders::intrinsic_verdict, {}, kSumLanes)),
      kept_(gpu::Buffer::create(device, gpu::Element::vec4, cells.pixels())),
      tiles_(gpu::Buffer::create(device, gpu::Element::scalar, tiles_of(cells))),
      sums_(gpu::Buffer::create(device, gpu::Element::vec4,
                                gpu::partial_count(*mismatch_, line_of(tiles_of(cells))))),
      verdict_(gpu::Buffer::create(device, gpu::Element::vec4, 1, gpu::Memory::readback)) {}

void TemporalAnchor::record(gpu::Commands& commands, const Guide& guide, const Params& params) {
  if (!cleared_) commands.fill(sums_);
  cleared_ = true;
  const struct {
    uint32_t width, height;
    float detail, chroma;
  } push{cells_.width, cells_.height, 1 / params.anchor_detail, 1 / params.anchor_chroma};
  commands.dispatch(mismatch_, {guide.cells(), guide.wide(), kept_, tiles_, sums_}, push,
                    line_of(tiles_of(cells_)));
  const struct {
    uint32_t count;
    float cells, cut_fraction;
  } decide{static_cast<uint32_t>(sums_->count()), static_cast<float>(cells_.pixels()),
           params.cut_fraction};
  commands.dispatch(decide_, {sums_, verdict_}, decide, {});
}

}  // namespace inverse
