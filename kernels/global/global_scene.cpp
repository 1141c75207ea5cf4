// SPDX-License-Identifier: LGPL-2.1-or-later
// Measurement of a scene by GlobalIntrinsic, on its small grids.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "global_model.hpp"

namespace inverse {

using namespace global_model;

namespace {

// Candidate amounts: the smallest, and the ratio of each to the one before.
constexpr float kMinAmount = 0.06F, kAmountRatio = 1.24F;
constexpr float kRenewColor = 0.05F;   // share of the newest frame in whether light has color
constexpr float kNeutralWidth = 0.2F;  // log chroma that still counts as neutral
constexpr float kEdge = 0.01F, kWindow = 0.05F;  // how residuals of chroma are smoothed (fit.comp)
// Of base colors in the histogram of chroma (modes.comp).
constexpr float kFollow = 0.1F;               // share of the newest frame in a color's usual place
constexpr int32_t kKeep = 50, kForget = 250;  // frames without a mode: stays, keeps its slot
constexpr float kGate = 0.01F;  // mean square tint of a scene at which half of the residual counts

}  // namespace

void GlobalIntrinsic::gather(gpu::Commands& commands, const Params& params, bool known) {
  const auto here = sizes();
  const gpu::Items coarse = line_of(coarse_.pixels()),
                   all = line_of(coarse_.pixels() * Model::kSlots);
  commands.dispatch(kernels_.emit[known ? 1 : 0],
                    {.colors = colors_, .scene = scene_, .labels = labels_, .emitted = emitted_},
                    here, coarse);
  commands.dispatch(kernels_.summary, {.colors = colors_, .labels = labels_, .means = means_}, here,
                    {});
  const shaders::global_gather_blur::Push blur{.size = extent_,
                                               .grid = grid_,
                                               .coarse = coarse_,
                                               .factor = factor_,
                                               .reach = static_cast<int32_t>(taps_->count() - 1)};
  commands.dispatch(kernels_.blur[0],
                    {.emitted = emitted_, .means = means_, .taps = taps_, .blurred = blurred_},
                    blur, all);
  commands.dispatch(kernels_.blur[1],
                    {.emitted = blurred_, .means = means_, .taps = taps_, .blurred = emitted_},
                    blur, all);
  commands.dispatch(kernels_.received,
                    {.blurred = emitted_, .means = means_, .received = known ? known_ : received_},
                    {.size = extent_,
                     .grid = grid_,
                     .coarse = coarse_,
                     .factor = factor_,
                     .near = params.near_share,
                     .own = params.own},
                    all);
}

void GlobalIntrinsic::measure_amount(gpu::Commands& commands, const Params& params) {
  commands.dispatch(kernels_.amount,
                    {.colors = colors_,
                     .points = points_,
                     .labels = labels_,
                     .received = received_,
                     .counts = candidates_},
                    {.size = extent_,
                     .grid = grid_,
                     .coarse = coarse_,
                     .factor = factor_,
                     .min_amount = kMinAmount,
                     .ratio = kAmountRatio,
                     .neutral = 1 / (2 * kNeutralWidth * kNeutralWidth)},
                    line_of(grid_.pixels()));
  commands.dispatch(kernels_.weigh, {.counts = candidates_, .scene = scene_},
                    {.ln_min = std::log(kMinAmount),
                     .ln_ratio = std::log(kAmountRatio),
                     .neutral = params.neutral,
                     .ln_typical = std::log(params.typical_amount),
                     .spread = params.spread,
                     .measurement_weight = params.measurement_weight,
                     .full_spread = params.full_spread,
                     .manual = params.amount,
                     .renew_color = kRenewColor},
                    {});
}

void GlobalIntrinsic::find_tint(gpu::Commands& commands, const Params& params) {
  commands.dispatch(kernels_.tint,
                    {.colors = colors_,
                     .points = points_,
                     .labels = labels_,
                     .received = received_,
                     .scene = scene_,
                     .counts = counts_,
                     .tints = tints_,
                     .sums = sums_},
                    sizes(), line_of(grid_.pixels()));
  commands.dispatch(
      kernels_.statistics, {.sums = sums_, .scene = scene_},
      {.count = static_cast<int32_t>(sums_->count()), .gate = kGate, .residual = params.residual},
      {});
}

void GlobalIntrinsic::find_colors(gpu::Commands& commands, const Params& params) {
  commands.dispatch(kernels_.modes,
                    {.counts = counts_,
                     .scene = scene_,
                     .slots = slots_,
                     .histogram = histogram_,
                     .heights = heights_,
                     .work = work_},
                    {.smoothing = params.smoothing,
                     .min_share = params.min_share,
                     .same = params.same_color,
                     .follow = kFollow,
                     .max_colors = params.base_colors,
                     .keep = kKeep,
                     .forget = kForget},
                    {});
}

PlanePtr GlobalIntrinsic::measure_grid(gpu::Commands& commands, const PlanePtr& frame,
                                       const Params& params, bool was_gray) {
  const auto make_grid = [&](size_t raw) {
    const auto& grid = plan_.gray ? kernels_.color_grid : kernels_.grid[raw];
    commands.dispatch(grid,
                      {.frame = frame->buffer,
                       .memory = memory_,
                       .scene = scene_,
                       .light_state = light_state(),
                       .colors = colors_,
                       .points = points_},
                      {.size = extent_,
                       .grid = grid_,
                       .coarse = coarse_,
                       .factor = factor_,
                       .white_level = params.scale.white_level},
                      line_of(grid_.pixels() * grid.kernel()->workgroup()));
  };
  const auto count = static_cast<int32_t>(grid_.pixels());
  const bool balances = params.white_balance > 0;
  // A change of white balance changes all colors.
  const bool forget = balances != std::exchange(balanced_, balances) || frames_ == 0;
  if (forget) commands.fill(scene_);
  // The grid of colors alone leaves no reflectance to compare with.
  const bool unknown = was_gray && !plan_.gray;
  const auto measure = [&](const Kernels::SceneStatistics& kernel) {
    commands.dispatch(kernel,
                      {.colors = colors_, .points = points_, .before = before_, .scene = scene_},
                      {.count = count,
                       .cut = params.cut_chroma,
                       .renew = params.update_rate,
                       .first = forget || unknown,
                       .none = params.no_color,
                       .full = params.amount > 0 ? 0 : params.full_color},
                      {});
  };
  if (!balances) {
    make_grid(0);
    measure(kernels_.decide_and_start);
    return nullptr;
  }
  make_grid(1);
  measure(kernels_.decide);
  PlanePtr lamp = lamps_.acquire();
  commands.dispatch(kernels_.white, {.colors = colors_, .scene = scene_, .lamp = lamp->buffer},
                    {.count = count, .share = params.white_balance}, {});
  make_grid(0);
  measure(kernels_.start);
  return lamp;
}

void GlobalIntrinsic::make_taps(const Params& params) {
  const float sigma = params.reach * static_cast<float>(coarse_.width);
  const auto reach = static_cast<size_t>(std::ceil(3 * sigma));
  const auto tap = [&](size_t d) {
    const auto distance = static_cast<float>(d);
    return std::exp(-0.5F * distance * distance / (sigma * sigma));
  };
  float all = 1;
  for (size_t d = 1; d <= reach; ++d) all += 2 * tap(d);
  // A new buffer: frames in flight still read the old one.
  taps_ = gpu::Buffer::create(device_, gpu::Element::scalar,
                              std::max(coarse_.width, coarse_.height), gpu::Memory::upload);
  for (size_t d = 0; d < taps_->count(); ++d)
    taps_->map_as<float>()[d] = d > reach ? 0 : tap(d) / all;
  reach_ = params.reach;
}

void GlobalIntrinsic::find_residual(gpu::Commands& commands) {
  const gpu::Items points = line_of(grid_.pixels());
  commands.dispatch(kernels_.label_confidence,
                    {.points = points_,
                     .tints = tints_,
                     .slots = slots_,
                     .scene = scene_,
                     .labels = labels_,
                     .raw = raw_},
                    {.count = static_cast<int32_t>(grid_.pixels()),
                     .residual_sigma = kResidualSigma,
                     .tint_sigma = kTintSigma},
                    points);
  const int32_t radius =
      std::max(1, static_cast<int32_t>(std::lround(kWindow * static_cast<float>(grid_.width))));
  for (size_t pass = 0; pass < 3; ++pass)
    commands.dispatch(
        kernels_.fit[pass],
        {.raw = raw_, .before = pass == 0 ? raw_ : fits_[pass - 1], .after = fits_[pass]},
        {.grid = grid_, .radius = radius, .edge = kEdge}, points);
}

void GlobalIntrinsic::find_scene(gpu::Commands& commands, const Params& params) {
  commands.fill(candidates_);
  commands.fill(counts_);
  commands.when(scene_, kUsable, [&] {
    gather(commands, params, false);
    measure_amount(commands, params);
    find_tint(commands, params);
    find_colors(commands, params);
    find_residual(commands);
  });
  commands.stage("scene");
}

}  // namespace inverse
