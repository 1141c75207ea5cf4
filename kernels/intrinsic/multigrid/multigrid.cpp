// SPDX-License-Identifier: LGPL-2.1-or-later
#include "multigrid.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/gpu/reduce.hpp"
#include "kernels/image/pyramid.hpp"

namespace inverse {
namespace {

constexpr uint64_t kTogether = 300;  // packs up to which levels run in one dispatch: 40 x 30 pixels
constexpr uint64_t kMaxPacks = shaders::intrinsic_multigrid_coarse::kMaxPacks;  // of those levels
constexpr uint64_t kCoarseStride =
    shaders::intrinsic_multigrid_smooth::SYSTEM_COARSE_STRIDE;  // vec4 a pack from level 2 on
constexpr float kMinMass = 1e-6F;  // keeps a frame of one pixel regular
constexpr size_t kCells = 2;       // the cells' level

/// Packs of a level and all coarser ones.
uint64_t packs_from(Extent extent) {
  uint64_t packs = pack4_count(extent);
  for (; extent.pixels() > 1; packs += pack4_count(extent)) extent = half_of(extent);
  return packs;
}

uint32_t stride_of(size_t level) { return level < kCells ? Multigrid::kFineStride : kCoarseStride; }

}  // namespace

Multigrid::Multigrid(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : smooth_{{device, {.stride = kFineStride, .cell_pixels = 4}},
              {device, {.stride = kFineStride, .cell_pixels = 2}}},
      correct_{{device, {.stride = kFineStride, .correct = true, .cell_pixels = 4}},
               {device, {.stride = kFineStride, .correct = true, .cell_pixels = 2}},
               {device, {.stride = kCoarseStride, .correct = true}}},
      coarsen_{{device, {.stride = kFineStride, .coarse_stride = kFineStride}},
               {device, {.stride = kFineStride, .coarse_stride = kCoarseStride, .terms = true}},
               {device, {.stride = kCoarseStride, .coarse_stride = kCoarseStride}}},
      restrict_{{device, {.stride = kFineStride, .means = 1}},
                {device, {.stride = kFineStride, .means = 2}},
                {device, {.stride = kCoarseStride}},
                {device, {.stride = kCoarseStride, .from_zero = true}}},
      extrapolate_(device),
      measure_(device, {.measure = true}) {
  const uint32_t lanes = device->variant().lone_workgroup;
  coarse_setup_ = {device, {.setup = true}, lanes};
  coarse_cycle_ = {device, {}, lanes};
  convergence_ = {device, {}, lanes};
  const auto buffer = [&](uint64_t count) {
    return gpu::Buffer::create(device, gpu::Element::vec4, count);
  };
  float mass = kMinMass;
  for (;
       levels_.size() < kCells || pack4_count(extent) > kTogether || packs_from(extent) > kMaxPacks;
       extent = half_of(extent), ++depth_, mass *= 4)
    levels_.push_back({extent, buffer(pack4_count(extent) * stride_of(levels_.size())),
                       buffer(pack4_count(extent)), mass});
  for (Extent level = extent; level.pixels() > 1; level = half_of(level)) ++depth_;
  levels_.push_back(
      {extent, buffer(packs_from(extent) * kCoarseStride), buffer(pack4_count(extent)), 0});
  half_means_ = buffer(pack4_count(levels_[1].extent));
  sums_ = buffer(gpu::partial_count(*measure_.kernel(), line_of(pack4_count(levels_[0].extent))));
  progress_ = gpu::Buffer::create(device, gpu::Element::vec4, 1);
  for (auto& start : starts_) start = buffer(pack4_count(levels_[0].extent));
  cell_means_ = buffer(pack4_count(levels_[kCells].extent));
  cell_residual_ = buffer(pack4_count(levels_[kCells].extent));
  cell_source_term_ = buffer(pack4_count(levels_[kCells].extent) * kSourceStride);
}

void Multigrid::relax(gpu::Commands& commands, size_t i, bool corrects) const {
  const Level& level = levels_[i];
  const auto& program = corrects ? correct_[std::min(i, kCells)] : smooth_[i];
  for (const uint32_t pass : {0U, 1U}) {
    const uint32_t color = corrects ? 1 - pass : pass;
    commands.dispatch(program,
                      {.system = level.system,
                       .now = level.field,
                       .coarse = corrects ? levels_[i + 1].field : level.field,
                       .source_term = cell_source_term_,
                       .improved = gpu::aliased(level.field)},
                      {.size = level.extent,
                       .finest = levels_[0].extent,
                       .color = color,
                       .mass = level.mass,
                       .around = static_cast<float>(color)},
                      line_of(static_cast<uint64_t>((pack4_count(level.extent.width) + 1) / 2) *
                              ((level.extent.height + 3) / 4)));
  }
}

void Multigrid::restrict_to(gpu::Commands& commands, size_t i) const {
  const Level &fine = levels_[i], &coarse = levels_[i + 1];
  const bool to_cells = i + 1 == kCells;
  // From level 3 on the correction is zero here; level 2 keeps that of the last V-cycle.
  commands.dispatch(
      restrict_[std::min(i, std::size(restrict_) - 1)],
      {.system = fine.system,
       .now = fine.field,
       .finer_means = gpu::aliased(half_means_),
       .source_term = cell_source_term_,
       .target = to_cells ? cell_residual_ : coarse.system,
       .coarse = coarse.field,
       .means = i == 0 ? half_means_ : cell_means_},
      {.size = fine.extent,
       .finest = levels_[0].extent,
       .mass = fine.mass,
       .target_stride = to_cells ? 1 : stride_of(i + 1),
       .target_slot = to_cells ? 0 : shaders::intrinsic_multigrid_restrict::SYSTEM_RHS},
      line_of(pack4_count(coarse.extent)));
}

void Multigrid::record_operators(gpu::Commands& commands, const Params& params) const {
  for (size_t i = 0; i + 1 < levels_.size(); ++i) {
    const Level &fine = levels_[i], &coarse = levels_[i + 1];
    commands.dispatch(
        coarsen_[std::min(i, kCells)],
        {.system = fine.system, .source_term = cell_source_term_, .coarse_system = coarse.system},
        {.size = fine.extent,
         .finest = levels_[0].extent,
         .scale = params.scale,
         .mass = fine.mass},
        line_of(pack4_count(coarse.extent)));
  }
  const Level& last = levels_.back();
  commands.dispatch(
      coarse_setup_,
      {.system = last.system, .operators = gpu::aliased(last.system), .field = last.field},
      {.size = last.extent, .scale = params.scale}, {});
}

void Multigrid::cell_cycle(gpu::Commands& commands, const Params& params) const {
  for (size_t i = kCells; i + 1 < levels_.size(); ++i) restrict_to(commands, i);
  const Level& last = levels_.back();
  commands.dispatch(
      coarse_cycle_,
      {.system = last.system, .operators = gpu::aliased(last.system), .field = last.field},
      {.size = last.extent, .scale = params.scale}, {});
  for (size_t i = levels_.size() - 1; i-- > kCells;) relax(commands, i, true);
}

void Multigrid::extrapolate(gpu::Commands& commands, float slowest, uint32_t k,
                            const Progress& progress) {
  // Errors of x <- V(x) shrink by factors between 0 and `slowest`: Varga, Matrix Iterative
  // Analysis, 5.1.
  const float ratio = slowest / (2 - slowest);
  float w = 1;
  for (uint32_t i = 0; i < k; ++i) w = 1 / (1 - ratio * ratio * w * (i == 0 ? 0.5F : 0.25F));
  if (!cleared_) commands.fill(sums_);
  cleared_ = true;
  const Extent extent = levels_[0].extent;
  commands.dispatch(progress.measured ? measure_ : extrapolate_,
                    {.now = field(),
                     .start = starts_[k % 2],
                     .before = starts_[(k == 0 || slowest <= 0 ? k : k + 1) % 2],
                     .next = gpu::aliased(field()),
                     .next_start = gpu::aliased(starts_[(k + 1) % 2]),
                     .sums = sums_},
                    {.packs = {pack4_count(extent.width), extent.height},
                     .w = w,
                     .c = 2 / (2 - slowest),
                     .last = progress.last},
                    line_of(pack4_count(extent)));
  if (!progress.measured) return;
  commands.dispatch(convergence_, {.sums = sums_, .progress = progress_},
                    {.count = static_cast<uint32_t>(sums_->count()),
                     .pixels = static_cast<float>(extent.pixels()),
                     .tolerance = progress.tolerance * progress.tolerance,
                     .first = k == 0},
                    {});
}

void Multigrid::record_cycle(gpu::Commands& commands, const Params& params, uint32_t k,
                             const Progress& progress, const std::function<void()>& before,
                             const std::function<void()>& after) {
  const bool from_start = params.slowest > 0 || progress.measured;
  const bool has_start = k > 0 && keeps_start_;
  keeps_start_ = from_start && !progress.last;
  if (from_start && !has_start) commands.copy(field(), starts_[k % 2], field()->bytes());
  const auto cycle = [&] {
    for (size_t i = 0; i < kCells; ++i) {
      relax(commands, i, false);
      restrict_to(commands, i);
    }
    commands.stage("descend");
    for (uint32_t inner = 0; inner < params.cell_cycles; ++inner) {
      before();
      cell_cycle(commands, params);
    }
    after();
    commands.stage("cells");
    for (size_t i = kCells; i-- > 0;) relax(commands, i, true);
    if (from_start) extrapolate(commands, params.slowest, k, progress);
    commands.stage("ascend");
  };
  constexpr uint64_t kGoesOn =
      sizeof(float) * shaders::intrinsic_multigrid_convergence::PROGRESS_CONTINUES;
  if (progress.conditional)
    commands.when(progress_, kGoesOn, cycle);
  else
    cycle();
}

}  // namespace inverse
