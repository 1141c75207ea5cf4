// SPDX-License-Identifier: LGPL-2.1-or-later
// What ThesisDecomposition reads back of a frame.
#include <cstring>

#include "kernels/gpu/reduce.hpp"
#include "thesis_decomposition.hpp"

namespace inverse {
namespace {

using Scalars = shaders::thesis_shared_scalars;
constexpr uint64_t kColors = 2 * Palette::kMaxClusters;
// Layout of a readback buffer, in vec4: scale, scalars, palette, strokes, trace.
constexpr uint64_t kScalarsAt = 1, kColorsAt = kScalarsAt + (Scalars::CG_SIZE + 3) / 4,
                   kStrokesAt = kColorsAt + kColors, kTraceAt = kStrokesAt + ThesisStrokes::kMax;

}  // namespace

void ThesisDecomposition::build_readback() {
  uint64_t entries = 1;
  if (params_.trace) {
    entries = levels_.size() * (static_cast<uint64_t>(params_.irls_iterations) + 1);
  }
  if ((params_.energy || params_.trace) && !energy_partials_) {
    for (auto* buffer : {&energy_partials_, &sample_partials_}) {
      *buffer = gpu::Buffer::create(
          device_, gpu::Element::vec4,
          gpu::partial_count(*solver().energy.kernel(), {extent_.width, extent_.height}));
    }
    cleared_ = false;
  }
  if (trace_ && trace_->count() >= entries) return;
  trace_ = gpu::Buffer::create(device_, gpu::Element::vec4, entries);
  for (Readback& readback : readback_) {
    readback.buffer =
        gpu::Buffer::create(device_, gpu::Element::vec4, kTraceAt + entries, gpu::Memory::readback);
    readback.stats = {};
  }
}

/// What `stats` reads.
void ThesisDecomposition::read_back(gpu::Commands& commands, const gpu::BufferPtr& target) {
  strokes_.record_means(commands, 0, levels_[0].solution);
  current_->strokes.resize(strokes_.count());
  commands.copy(scale_.value(), target, sizeof(float));
  commands.copy(scalars_, target, Scalars::CG_SIZE * sizeof(float), 0, 16 * kScalarsAt);
  commands.copy(palette_.colors(), target, 16 * kColors, 0, 16 * kColorsAt);
  if (!strokes_.empty())
    commands.copy(strokes_.spreads(), target, 16 * strokes_.count(), 0, 16 * kStrokesAt);
  if (!current_->energy.empty())
    commands.copy(trace_, target, 16 * current_->energy.size(), 0, 16 * kTraceAt);
}

ThesisDecomposition::Stats ThesisDecomposition::stats(uint64_t frame) const {
  if (recorded_ == 0) return {};
  if (frame >= recorded_ || frame + readback_.size() < recorded_) {
    throw Error(ErrorKind::internal, "statistics are kept for the last three frames only");
  }
  const Readback& readback = readback_[frame];
  const auto* values = readback.buffer->map_as<float>();
  Stats stats = readback.stats;
  stats.scale = values[0];
  if (params_.solver == Params::Solver::pcg) {
    stats.iterations = static_cast<int>(values[4 * kScalarsAt + Scalars::CG_ITERATIONS]);
    stats.residual = values[4 * kScalarsAt + Scalars::CG_RZ];
  }
  stats.clusters = Palette::read(values + 4 * kColorsAt, palette_.params().clusters);
  for (size_t k = 0; k < stats.clusters.size(); ++k)
    if (stats.clusters[k].index == static_cast<int>(k)) ++stats.cluster_count;
  for (size_t k = 0; k < stats.strokes.size(); ++k) stats.strokes[k] = values[4 * (kStrokesAt + k)];
  for (size_t n = 0; n < stats.energy.size(); ++n)
    std::memcpy(&stats.energy[n].data_and_chromaticity, values + 4 * (kTraceAt + n),
                4 * sizeof(float));
  return stats;
}

}  // namespace inverse
