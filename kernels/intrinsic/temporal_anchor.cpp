#include "temporal_anchor.hpp"

#include "../gpu/reduce.hpp"
#include "../gpu/shaders.hpp"

INVERSE_SHADER(intrinsic_mismatch);
INVERSE_SHADER(intrinsic_verdict);

namespace inverse {
namespace {
constexpr uint32_t kSumLanes = 64;  // of verdict.comp
constexpr uint64_t blocks_of(Extent extent) {
  return static_cast<uint64_t>((extent.width + 7) / 8) * ((extent.height + 7) / 8);
}
}  // namespace

TemporalAnchor::TemporalAnchor(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : extent_(extent),
      mismatch_(device->kernel(shaders::intrinsic_mismatch)),
      decide_(device->kernel(shaders::intrinsic_verdict, {}, kSumLanes)),
      kept_(gpu::Buffer::create(device, gpu::Element::vec4, extent.pixels())),
      blocks_(gpu::Buffer::create(device, gpu::Element::scalar, blocks_of(extent))),
      sums_(gpu::Buffer::create(device, gpu::Element::vec4, gpu::partial_count(*mismatch_, line_of(blocks_of(extent))))),
      verdict_(gpu::Buffer::create(device, gpu::Element::vec4, 1, gpu::Memory::readback)) {}

void TemporalAnchor::record(gpu::Commands& commands, const Guide& guide, const Params& params) {
  if (!cleared_) commands.fill(sums_);
  cleared_ = true;
  const struct {
    uint32_t width, height;
    float detail, chroma;
  } push{extent_.width, extent_.height, 1 / params.anchor_detail, 1 / params.anchor_chroma};
  commands.dispatch(mismatch_, {guide.level0(), guide.cells(), kept_, blocks_, sums_}, push,
                    line_of(blocks_of(extent_)));
  const struct {
    uint32_t count;
    float pixels, cut_fraction;
  } decide{static_cast<uint32_t>(sums_->count()), static_cast<float>(extent_.pixels()), params.cut_fraction};
  commands.dispatch(decide_, {sums_, verdict_}, decide, {});
}

}  // namespace inverse
