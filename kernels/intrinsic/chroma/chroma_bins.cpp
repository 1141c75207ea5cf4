// SPDX-License-Identifier: LGPL-2.1-or-later
#include "chroma_bins.hpp"

#include <algorithm>

#include "kernels/gpu/reduce.hpp"

namespace inverse {
namespace {

constexpr uint32_t kBins =
    shaders::intrinsic_chroma_bin_means::kBins * shaders::intrinsic_chroma_bin_means::kBins;
constexpr uint32_t kWords = 2;         // of a sum
constexpr uint32_t kTables = 16;       // copies of the bins without atomics
constexpr uint32_t kTableLanes = 8;    // invocations that one processor advances together
constexpr uint32_t kMaxLanes = 32768;  // with atomics: each workgroup adds all its bins

/// Invocations of a workgroup: many if they share its bins.
uint32_t lanes_of(const gpu::Device& device) {
  return device.variant().own_tables ? kTableLanes : device.variant().lone_workgroup;
}

}  // namespace

ChromaBins::ChromaBins(const std::shared_ptr<gpu::Device>& device, Extent cells)
    : cells_(cells),
      tables_(device->variant().own_tables ? kTables : 1),
      weigh_(device, {.weights = true, .tables = tables_}, lanes_of(*device)),
      splat_(device, {.tables = tables_}, lanes_of(*device)),
      sum_weights_(device, {.weights = true, .tables = static_cast<int32_t>(tables_)}),
      mean_(device, {.tables = static_cast<int32_t>(tables_)}),
      slice_(device),
      without_bins_(device, {.has_bins = false}),
      source_term_(device),
      measuring_source_term_(device, {.measure = true}),
      total_(device),
      table_sums_(gpu::Buffer::create(device, gpu::Element::word, kWords * kBins * tables_)),
      weights_(gpu::Buffer::create(device, gpu::Element::scalar, kBins)),
      means_(gpu::Buffer::create(device, gpu::Element::scalar, kBins)),
      target_(gpu::Buffer::create(device, gpu::Element::vec4, pack4_count(cells))),
      sums_(gpu::Buffer::create(
          device, gpu::Element::vec4,
          gpu::partial_count(*measuring_source_term_.kernel(), line_of(pack4_count(cells))))),
      binding_(gpu::Buffer::create(device, gpu::Element::vec4, 1)) {}

gpu::Items ChromaBins::splat_items() const {
  return line_of(tables_ > 1 ? tables_ : std::min<uint64_t>(pack4_count(cells_), kMaxLanes));
}

void ChromaBins::clear_once(gpu::Commands& commands) {
  if (cleared_) return;
  commands.fill(table_sums_);
  commands.fill(sums_);
  cleared_ = true;
}

void ChromaBins::record_weights(gpu::Commands& commands, const Guide& guide,
                                const gpu::BufferPtr& terms, float max_weight) {
  on_ = max_weight > 0;
  if (!on_) return;
  // The largest for which no cell overflows a word.
  scale_ = 4.0e9F / std::max(max_weight, 1e-20F);
  clear_once(commands);
  commands.dispatch(weigh_,
                    {.cells = guide.cells(),
                     .terms = terms,
                     .mean = terms,
                     .correction = terms,
                     .sums = table_sums_},
                    {.size = cells_, .scale = scale_}, splat_items());
  // Reads no weights.
  commands.dispatch(sum_weights_, {.sums = table_sums_, .weights = means_, .values = weights_},
                    {kBins});
}

void ChromaBins::record(gpu::Commands& commands, const Guide& guide, const State& state) const {
  if (on_) {
    commands.dispatch(splat_,
                      {.cells = guide.cells(),
                       .terms = state.terms,
                       .mean = state.means,
                       .correction = state.correction,
                       .sums = table_sums_},
                      {.size = cells_, .scale = scale_}, splat_items());
    commands.dispatch(mean_, {.sums = table_sums_, .weights = weights_, .values = means_}, {kBins});
  }
  commands.dispatch(on_ ? slice_ : without_bins_,
                    {.cells = guide.cells(),
                     .terms = state.terms,
                     .mean = state.means,
                     .far = state.far,
                     .means = means_,
                     .system = state.system,
                     .target = target_},
                    {.size = cells_}, line_of(pack4_count(cells_)));
}

void ChromaBins::record_source_term(gpu::Commands& commands, const State& state, bool measure) {
  clear_once(commands);
  commands.dispatch(measure ? measuring_source_term_ : source_term_,
                    {.terms = state.terms,
                     .target = target_,
                     .mean = state.means,
                     .correction = state.correction,
                     .source_term = state.source_term,
                     .sums = sums_},
                    {.size = cells_}, line_of(pack4_count(cells_)));
  if (measure)
    commands.dispatch(total_, {.sums = sums_, .total = binding_},
                      {.count = static_cast<uint32_t>(sums_->count())}, {});
}

}  // namespace inverse
