#include "chroma_bins.hpp"

#include <algorithm>
#include <array>

#include "kernels/gpu/reduce.hpp"
#include "kernels/gpu/shaders.hpp"

INVERSE_SHADER(intrinsic_chroma_bin_splat);
INVERSE_SHADER(intrinsic_chroma_bin_means);
INVERSE_SHADER(intrinsic_chroma_bin_slice);
INVERSE_SHADER(intrinsic_chroma_force);
INVERSE_SHADER(solve_total);

namespace inverse {
namespace {

constexpr uint32_t kBins = 48 * 48;  // as in bins.glsl
constexpr uint32_t kTables = 16;     // tables of bins where invocations have their own
constexpr uint32_t kTableLanes = 8;  // invocations that one processor advances together

struct SplatPush {
  uint32_t width, height;
  float scale;
};

}  // namespace

ChromaBins::ChromaBins(const std::shared_ptr<gpu::Device>& device, Extent cells)
    : cells_(cells),
      tables_(device->variant().own_tables ? kTables : 1),
      weigh_(device->kernel(shaders::intrinsic_chroma_bin_splat, {1, tables_},
                            tables_ > 1 ? kTableLanes : 0)),
      splat_(device->kernel(shaders::intrinsic_chroma_bin_splat, {0, tables_},
                            tables_ > 1 ? kTableLanes : 0)),
      mean_(device->kernel(shaders::intrinsic_chroma_bin_means, {tables_})),
      slice_(device->kernel(shaders::intrinsic_chroma_bin_slice, {1})),
      pull_(device->kernel(shaders::intrinsic_chroma_bin_slice, {0})),
      force_(device->kernel(shaders::intrinsic_chroma_force, {0})),
      looking_force_(device->kernel(shaders::intrinsic_chroma_force, {1})),
      total_(device->kernel(shaders::solve_total)),
      weights_(gpu::Buffer::create(device, gpu::Element::word, kBins * tables_)),
      totals_(gpu::Buffer::create(device, gpu::Element::word, kBins * tables_)),
      means_(gpu::Buffer::create(device, gpu::Element::scalar, kBins)),
      wanted_(gpu::Buffer::create(device, gpu::Element::vec4, quads_of(cells))),
      sums_(gpu::Buffer::create(device, gpu::Element::vec4,
                                gpu::partial_count(*looking_force_, line_of(quads_of(cells))))),
      binding_(gpu::Buffer::create(device, gpu::Element::vec4, 1)) {}

gpu::Items ChromaBins::splat_items() const {
  return line_of(tables_ > 1 ? tables_ : quads_of(cells_));
}

void ChromaBins::record_weights(gpu::Commands& commands, const Guide& guide,
                                const gpu::BufferPtr& terms, float most_weight) {
  on_ = most_weight > 0;
  if (!on_) return;
  // The largest for which a frame of one chroma does not overflow 31 bits.
  scale_ = 2.0e9F / std::max(static_cast<float>(cells_.pixels()) * most_weight, 1e-20F);
  commands.fill(weights_);
  commands.fill(totals_);
  commands.dispatch(weigh_, {guide.cells(), terms, terms, terms, weights_},
                    SplatPush{cells_.width, cells_.height, scale_}, splat_items());
}

void ChromaBins::record(gpu::Commands& commands, const Guide& guide, const State& state) const {
  if (on_) {
    commands.dispatch(splat_, {guide.cells(), state.terms, state.means, state.correction, totals_},
                      SplatPush{cells_.width, cells_.height, scale_}, splat_items());
    commands.dispatch(mean_, {weights_, totals_, means_}, {kBins});
  }
  const std::array<uint32_t, 2> size{cells_.width, cells_.height};
  commands.dispatch(
      on_ ? slice_ : pull_,
      {guide.cells(), state.terms, state.means, state.far, means_, state.system, wanted_}, size,
      line_of(quads_of(cells_)));
}

void ChromaBins::record_force(gpu::Commands& commands, const State& state, bool look) {
  if (!cleared_) commands.fill(sums_);
  cleared_ = true;
  const std::array<uint32_t, 2> size{cells_.width, cells_.height};
  commands.dispatch(look ? looking_force_ : force_,
                    {state.terms, wanted_, state.means, state.correction, state.force, sums_}, size,
                    line_of(quads_of(cells_)));
  if (look) commands.dispatch(total_, {sums_, binding_}, static_cast<uint32_t>(sums_->count()), {});
}

}  // namespace inverse
