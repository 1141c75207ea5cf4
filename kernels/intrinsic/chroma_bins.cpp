#include "chroma_bins.hpp"

#include <algorithm>
#include <array>

#include "../gpu/shaders.hpp"

INVERSE_SHADER(intrinsic_bin_weights);
INVERSE_SHADER(intrinsic_bin_splat);
INVERSE_SHADER(intrinsic_bin_means);
INVERSE_SHADER(intrinsic_bin_slice);

namespace inverse {
namespace {
constexpr uint32_t kBins = 48 * 48;  // as in bins.glsl
}

ChromaBins::ChromaBins(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : extent_(extent),
      weigh_(device->kernel(shaders::intrinsic_bin_weights)),
      splat_(device->kernel(shaders::intrinsic_bin_splat)),
      mean_(device->kernel(shaders::intrinsic_bin_means)),
      slice_(device->kernel(shaders::intrinsic_bin_slice)),
      weights_(gpu::Buffer::create(device, gpu::Element::word, kBins)),
      totals_(gpu::Buffer::create(device, gpu::Element::word, kBins)),
      sums_(gpu::Buffer::create(device, gpu::Element::vec4,
                                static_cast<uint64_t>(quads_of(extent.width)) * ((extent.height + 3) / 4))),
      means_(gpu::Buffer::create(device, gpu::Element::vec4, kBins)) {}

void ChromaBins::record_frame(gpu::Commands& commands, const Guide& guide, const gpu::BufferPtr& value,
                              float most_weight) {
  // The largest step for which a frame of one chroma does not overflow 31 bits.
  scale_ = 2.0e9F / std::max(static_cast<float>(extent_.pixels()) * most_weight, 1e-20F);
  commands.fill(weights_);
  const struct {
    uint32_t width, height;
    float scale;
  } push{extent_.width, extent_.height, scale_};
  commands.dispatch(weigh_, {guide.level0(), guide.cells(), value, weights_, sums_}, push, line_of(sums_->count()));
}

void ChromaBins::record(gpu::Commands& commands, const Guide& guide, const gpu::BufferPtr& value,
                        const gpu::BufferPtr& base, const gpu::BufferPtr& shading,
                        const gpu::BufferPtr& system) const {
  commands.fill(totals_);
  const struct {
    uint32_t width, height;
    float scale;
  } push{extent_.width, extent_.height, scale_};
  commands.dispatch(splat_, {sums_, value, shading, totals_}, push, line_of(sums_->count()));
  commands.dispatch(mean_, {weights_, totals_, means_}, {kBins});
  const std::array<uint32_t, 2> size{extent_.width, extent_.height};
  commands.dispatch(slice_, {guide.level0(), value, base, shading, means_, system}, size,
                    line_of(quads_of(extent_)));
}

}  // namespace inverse
