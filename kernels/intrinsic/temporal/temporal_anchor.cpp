#include "temporal_anchor.hpp"

#include <array>

#include "kernels/gpu/reduce.hpp"
#include "kernels/gpu/shaders.hpp"
#include "kernels/image/pyramid.hpp"

INVERSE_SHADER(intrinsic_temporal_mismatch);
INVERSE_SHADER(intrinsic_temporal_calm);
INVERSE_SHADER(image_tiles_carry);
INVERSE_SHADER(intrinsic_temporal_verdict);

namespace inverse {
namespace {
constexpr uint32_t kSumLanes = 64;  // of verdict.comp
/// One tile a 4 x 4 cells.
constexpr uint64_t tiles_of(Extent cells) {
  return static_cast<uint64_t>(quads_of(cells.width)) * ((cells.height + 3) / 4);
}
}  // namespace

TemporalAnchor::TemporalAnchor(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : extent_(extent),
      cells_(half_of(half_of(extent))),
      compare_(device, shaders::intrinsic_temporal_mismatch, {}, 4, 4),
      carry_(device, shaders::image_tiles_carry, {kMemoryStride}, 4, 16),
      calm_(device->kernel(shaders::intrinsic_temporal_calm)),
      decide_(device->kernel(shaders::intrinsic_temporal_verdict, {}, kSumLanes)),
      kept_(gpu::Buffer::create(device, gpu::Element::vec4, cells_.pixels())),
      memory_(gpu::Buffer::create(device, gpu::Element::vec4, kMemoryStride * quads_of(extent))),
      now_(gpu::Buffer::create(device, gpu::Element::vec4, kMemoryStride * quads_of(extent))),
      mismatch_(gpu::Buffer::create(device, gpu::Element::vec4, cells_.pixels())),
      tiles_(gpu::Buffer::create(device, gpu::Element::vec4, tiles_of(cells_))),
      sums_(gpu::Buffer::create(device, gpu::Element::vec4,
                                gpu::partial_count(*calm_, line_of(tiles_of(cells_))))),
      verdict_(gpu::Buffer::create(device, gpu::Element::vec4, 1)) {}

void TemporalAnchor::record(gpu::Commands& commands, const Guide& guide, const Params& params,
                            bool continues, const TileList* listed) {
  if (!cleared_) commands.fill(sums_);
  cleared_ = true;
  const struct {
    uint32_t width, height;
    float detail, chroma, texture;
  } push{extent_.width, extent_.height, 1 / params.anchor_detail, 1 / params.anchor_chroma,
         1 / params.anchor_texture};
  compare_.dispatch(commands, listed,
                    {guide.cells(), guide.wide(), guide.level0(), kept_, memory_, mismatch_}, push,
                    line_of(cells_.pixels()));
  const std::array<uint32_t, 2> size{cells_.width, cells_.height};
  commands.dispatch(calm_, {mismatch_, tiles_, sums_}, size, line_of(tiles_of(cells_)));
  const struct {
    uint32_t count;
    float cells, cut_fraction, continues;
  } decide{static_cast<uint32_t>(sums_->count()), static_cast<float>(cells_.pixels()),
           params.cut_fraction, continues ? 1.0F : 0.0F};
  commands.dispatch(decide_, {sums_, verdict_}, decide, {});
}

void TemporalAnchor::advance(gpu::Commands& commands, const TileList* listed) {
  const std::array<uint32_t, 2> quads{quads_of(extent_.width), extent_.height};
  if (listed)
    carry_.dispatch(commands, listed, {now_, memory_}, quads, {});
  else
    memory_.swap(now_);
}

}  // namespace inverse
