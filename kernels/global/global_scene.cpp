// What GlobalIntrinsic finds out about a scene, on its small grids.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "global_model.hpp"

namespace inverse {

using namespace global_model;

namespace {

// Of candidate amounts: the least, and each to the one before.
constexpr float kLeastAmount = 0.06F, kAmountRatio = 1.24F;
constexpr float kRenewColor = 0.05F;   // share of the newest frame in whether light has color
constexpr float kNeutralWidth = 0.2F;  // log chroma that still counts as neutral
constexpr float kEdge = 0.01F, kWindow = 0.05F;  // how residuals of chroma are smoothed (fit.comp)
// Of base colors in the histogram of chroma (modes.comp).
constexpr float kFollow = 0.1F;               // share of the newest frame in where one usually is
constexpr int32_t kKeep = 50, kForget = 250;  // frames without a mode: stays, keeps its slot
constexpr float kGate = 0.01F;  // mean square tint of a scene where half of the residual is taken

}  // namespace

void GlobalIntrinsic::gather(gpu::Commands& commands, const Params& params, bool known) {
  const Place here = place();
  const gpu::Items coarse = line_of(coarse_.pixels()), all = line_of(coarse_.pixels() * kSlots);
  commands.dispatch(kernels_.emit[known ? 1 : 0], {colors_, scene_, labels_, emitted_}, here,
                    coarse);
  commands.dispatch(kernels_.summary, {colors_, labels_, means_}, here, {});
  const struct {
    Place place;
    uint32_t reach;
  } blur{here, static_cast<uint32_t>(taps_->count() - 1)};
  commands.dispatch(kernels_.blur[0], {emitted_, means_, taps_, blurred_}, blur, all);
  commands.dispatch(kernels_.blur[1], {blurred_, means_, taps_, emitted_}, blur, all);
  const struct {
    Place place;
    float near, own;
  } received{here, params.near, params.own};
  commands.dispatch(kernels_.received, {emitted_, means_, known ? known_ : received_}, received,
                    all);
}

void GlobalIntrinsic::measure_amount(gpu::Commands& commands, const Params& params) {
  const struct {
    Place place;
    float least, ratio, neutral;
  } amount{place(), kLeastAmount, kAmountRatio, 1 / (2 * kNeutralWidth * kNeutralWidth)};
  commands.dispatch(kernels_.amount, {colors_, points_, labels_, received_, candidates_}, amount,
                    line_of(grid_.pixels()));
  const struct {
    float ln_least, ln_ratio, neutral, ln_typical, spread, trust, full_trust, manual, renew_color;
  } weigh{std::log(kLeastAmount),   std::log(kAmountRatio), params.neutral,
          std::log(params.typical), params.spread,          params.trust,
          params.full_trust,        params.amount,          kRenewColor};
  commands.dispatch(kernels_.weigh, {candidates_, scene_}, weigh, {});
}

void GlobalIntrinsic::find_tint(gpu::Commands& commands, const Params& params) {
  commands.dispatch(kernels_.tint,
                    {colors_, points_, labels_, received_, scene_, counts_, tints_, sums_}, place(),
                    line_of(grid_.pixels()));
  const struct {
    int32_t count;
    float gate, residual;
  } statistics{static_cast<int32_t>(sums_->count()), kGate, params.residual};
  commands.dispatch(kernels_.statistics, {sums_, scene_}, statistics, {});
}

void GlobalIntrinsic::find_colors(gpu::Commands& commands, const Params& params) {
  const struct {
    float smoothing, least_share, same, follow;
    int32_t most, keep, forget;
  } modes{params.smoothing, params.least_share, params.same_color,
          kFollow,          params.base_colors, kKeep,
          kForget};
  commands.dispatch(kernels_.modes, {counts_, scene_, slots_, histogram_, heights_, work_}, modes,
                    {});
}

PlanePtr GlobalIntrinsic::look(gpu::Commands& commands, const PlanePtr& frame, const Params& params,
                               bool plain) {
  const struct {
    Place place;
    float white_level;
  } grid{place(), params.scale.white_level};
  const auto make_grid = [&](size_t raw) {
    commands.dispatch(plain ? kernels_.plain_grid : kernels_.grid[raw],
                      {frame->buffer, memory_, scene_, colors_, points_}, grid,
                      line_of(grid_.pixels()));
  };
  const auto count = static_cast<int32_t>(grid_.pixels());
  const bool balances = params.white_balance > 0;
  // Colors were others before.
  const bool forget = balances != std::exchange(balanced_, balances) || frames_ == 0;
  if (forget) commands.fill(scene_);
  // How bright reflectance was is not known where it was not asked for.
  const bool blind = std::exchange(rested_, plain) && !plain;
  const struct {
    int32_t count;
    float cut, renew;
    uint32_t first;
    float none, full;
  } look{count,           params.cut,
         params.renew,    forget || blind ? 1U : 0U,
         params.no_color, params.amount > 0 ? 0 : params.full_color};
  const auto look_at = [&](const gpu::KernelPtr& kernel) {
    commands.dispatch(kernel, {colors_, points_, before_, scene_}, look, {});
  };
  if (!balances) {
    make_grid(0);
    look_at(kernels_.decide_and_start);
    return nullptr;
  }
  make_grid(1);
  look_at(kernels_.decide);
  PlanePtr lamp = lamps_.acquire();
  const struct {
    int32_t count;
    float share;
  } white{count, params.white_balance};
  commands.dispatch(kernels_.white, {colors_, scene_, lamp->buffer}, white, {});
  make_grid(0);
  look_at(kernels_.start);
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
  // A new one: what is in flight still reads the old.
  taps_ = gpu::Buffer::create(device_, gpu::Element::scalar,
                              std::max(coarse_.width, coarse_.height), gpu::Memory::upload);
  for (size_t d = 0; d < taps_->count(); ++d)
    taps_->map_as<float>()[d] = d > reach ? 0 : tap(d) / all;
  reach_ = params.reach;
}

void GlobalIntrinsic::find_residual(gpu::Commands& commands) {
  const gpu::Items points = line_of(grid_.pixels());
  const struct {
    int32_t count;
    float trust, trust_tint;
  } believe{static_cast<int32_t>(grid_.pixels()), kTrust, kTrustTint};
  commands.dispatch(kernels_.believe, {points_, tints_, slots_, scene_, labels_, raw_}, believe,
                    points);
  const struct {
    uint32_t grid[2];
    int32_t radius;
    float edge;
  } fit{{grid_.width, grid_.height},
        std::max(1, static_cast<int32_t>(std::lround(kWindow * static_cast<float>(grid_.width)))),
        kEdge};
  for (size_t pass = 0; pass < 3; ++pass)
    commands.dispatch(kernels_.fit[pass], {raw_, pass == 0 ? raw_ : fits_[pass - 1], fits_[pass]},
                      fit, points);
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
