#include "global_intrinsic.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "../gpu/reduce.hpp"
#include "../gpu/shaders.hpp"
#include "../intrinsic/quads.hpp"

INVERSE_SHADER(global_amount);
INVERSE_SHADER(global_believe);
INVERSE_SHADER(global_blur);
INVERSE_SHADER(global_direct);
INVERSE_SHADER(global_emit);
INVERSE_SHADER(global_fields);
INVERSE_SHADER(global_fit);
INVERSE_SHADER(global_grid);
INVERSE_SHADER(global_look);
INVERSE_SHADER(global_modes);
INVERSE_SHADER(global_received);
INVERSE_SHADER(global_shares);
INVERSE_SHADER(global_statistics);
INVERSE_SHADER(global_summary);
INVERSE_SHADER(global_tint);
INVERSE_SHADER(global_untint);
INVERSE_SHADER(global_weigh);
INVERSE_SHADER(global_white);

namespace inverse {
namespace {

// model.glsl
constexpr uint32_t kSlots = 16, kBinCount = 64 * 64, kCandidates = 16, kSceneAmount = 0,
                   kSceneTint = 1, kSceneTime = 2, kSceneColors = 8, kSceneSize = 24;
constexpr uint64_t kWorkWords = 4 * kBinCount + 1 + 1024;  // modes.comp
constexpr uint64_t kUsable = 16 * kSceneTint + 8;          // bytes into the scene's buffer
constexpr uint32_t kMostPoints = 40;                       // along the longer side of the grid
/// Frames in a row without color to go by after which that alone is looked at.
constexpr uint32_t kRest = 8;

// Of candidate amounts: the least, and each to the one before.
constexpr float kLeastAmount = 0.06F, kAmountRatio = 1.24F;
constexpr float kNeutralWidth = 0.2F;  // log chroma that still counts as neutral
// How residuals of chroma are believed (residual.glsl), and smoothed (fit.comp).
constexpr float kTrust = 0.35F, kTrustTint = 0.7F, kEdge = 0.01F, kWindow = 0.05F;
constexpr float kGate = 0.01F;  // mean square tint of a scene where half of the residual is taken

Extent reduced(Extent extent, uint32_t factor) {
  return {(extent.width + factor - 1) / factor, (extent.height + factor - 1) / factor};
}

uint32_t factor_for(Extent extent) {
  uint32_t factor = 1;
  while (std::max(reduced(extent, factor).width, reduced(extent, factor).height) > kMostPoints)
    factor *= 2;
  return factor;
}

GlobalIntrinsic::Params within_ranges(GlobalIntrinsic::Params params) {
  const auto keep = [](auto& value, auto low, auto high) {
    value = value > low ? std::min(value, high) : low;  // low for what is not a number
  };
  keep(params.reach, 0.02F, 2.0F);
  keep(params.near, 0.0F, 1.0F);
  keep(params.own, 0.0F, 0.95F);
  keep(params.amount, 0.0F, 2.0F);
  keep(params.neutral, 0.0F, 100.0F);
  keep(params.typical, 0.05F, 2.0F);
  keep(params.spread, 0.05F, 10.0F);
  keep(params.trust, 0.0F, 100.0F);
  keep(params.base_colors, 1, static_cast<int>(kSlots));
  keep(params.least_share, 0.0F, 0.5F);
  keep(params.same_color, 0.0F, 10.0F);
  keep(params.renew, 0.01F, 1.0F);
  keep(params.white_balance, 0.0F, 1.0F);
  keep(params.cut, 0.0F, 1.0F);
  keep(params.smoothing, 0.5F, 2.5F);
  keep(params.residual, 0.0F, 1.0F);
  keep(params.no_color, 0.0F, 1.0F);
  keep(params.full_color, params.no_color + 1e-3F, 2.0F);
  return params;
}

gpu::Items pixels_of(Extent extent) { return {extent.width, extent.height}; }

}  // namespace

struct GlobalIntrinsic::Place {
  uint32_t size[2], grid[2], coarse[2], factor;
};

GlobalIntrinsic::GlobalIntrinsic(std::shared_ptr<gpu::Device> device, Extent extent)
    : device_(std::move(device)),
      extent_(extent),
      factor_(factor_for(extent)),
      solve_(device_, extent),
      planes_(device_, extent),
      bases_(device_, {kMaxBases, 1}),
      lamps_(device_, {1, 1}) {
  grid_ = reduced(extent_, factor_);
  coarse_ = reduced(grid_, 2);
  const uint32_t lanes = device_->variant().lone_workgroup;
  tint_ = device_->kernel(shaders::global_tint);
  white_ = device_->kernel(shaders::global_white, {}, lanes);
  look_ = device_->kernel(shaders::global_look, {1, 1}, lanes);
  decide_ = device_->kernel(shaders::global_look, {1, 0}, lanes);
  start_ = device_->kernel(shaders::global_look, {0, 1}, lanes);
  // Where points are eight pixels apart, four aligned ones lie between the same.
  untint_ = device_->kernel(shaders::global_untint, {factor_ >= 8 ? 1U : 0U});
  summary_ = device_->kernel(shaders::global_summary, {}, lanes);
  received_kernel_ = device_->kernel(shaders::global_received);
  amount_ = device_->kernel(shaders::global_amount);
  statistics_ = device_->kernel(shaders::global_statistics, {}, lanes);
  fields_kernel_ = device_->kernel(shaders::global_fields);
  believe_ = device_->kernel(shaders::global_believe);
  direct_ = device_->kernel(shaders::global_direct);
  weigh_ = device_->kernel(shaders::global_weigh, {}, lanes);
  modes_ = device_->kernel(shaders::global_modes, {}, lanes);
  for (const uint32_t k : {0U, 1U}) {
    grid_kernel_[k] = device_->kernel(shaders::global_grid, {k});
    emit_[k] = device_->kernel(shaders::global_emit, {k});
    blur_[k] = device_->kernel(shaders::global_blur, {k});
  }
  plain_grid_ = device_->kernel(shaders::global_grid, {0, 1});
  for (const uint32_t pass : {0U, 1U, 2U})
    fit_[pass] = device_->kernel(shaders::global_fit, {pass});

  using gpu::Buffer;
  using gpu::Element;
  const uint64_t points = grid_.pixels(), coarse = coarse_.pixels();
  const auto buffer = [&](Element element, uint64_t count) {
    return Buffer::create(device_, element, count);
  };
  memory_ = buffer(Element::scalar, extent_.pixels());
  for (gpu::BufferPtr* plane :
       {&colors_, &points_, &before_, &tints_, &raw_, &fits_[0], &fits_[1], &fits_[2]})
    *plane = buffer(Element::vec4, points);
  labels_ = buffer(Element::word, points);
  for (gpu::BufferPtr* plane : {&emitted_, &blurred_, &received_})
    *plane = buffer(Element::vec4, coarse * kSlots);
  means_ = buffer(Element::vec4, kSlots);
  candidates_ = buffer(Element::word, kCandidates * (kBinCount + 2));
  counts_ = buffer(Element::word, kBinCount);
  histogram_ = buffer(Element::scalar, kBinCount);
  heights_ = buffer(Element::scalar, uint64_t{2} * kBinCount);
  work_ = buffer(Element::word, kWorkWords);
  slots_ = buffer(Element::word, kBinCount);
  sums_ = buffer(Element::vec4, gpu::partial_count(*tint_, line_of(points)));
  scene_ = buffer(Element::vec4, kSceneSize);
}

void GlobalIntrinsic::reset() {
  solve_.reset();
  frames_ = 0;
  gray_ = 0;
}

GlobalIntrinsic::Place GlobalIntrinsic::place() const {
  return {{extent_.width, extent_.height},
          {grid_.width, grid_.height},
          {coarse_.width, coarse_.height},
          factor_};
}

void GlobalIntrinsic::gather(gpu::Commands& commands, const Params& params, bool known) {
  const Place here = place();
  const gpu::Items coarse = line_of(coarse_.pixels()), all = line_of(coarse_.pixels() * kSlots);
  commands.dispatch(emit_[known ? 1 : 0], {colors_, scene_, labels_, emitted_}, here, coarse);
  commands.dispatch(summary_, {colors_, labels_, means_}, here, {});
  const struct {
    Place place;
    uint32_t reach;
  } blur{here, static_cast<uint32_t>(taps_->count() - 1)};
  commands.dispatch(blur_[0], {emitted_, means_, taps_, blurred_}, blur, all);
  commands.dispatch(blur_[1], {blurred_, means_, taps_, emitted_}, blur, all);
  const struct {
    Place place;
    float near, own;
  } received{here, params.near, params.own};
  commands.dispatch(received_kernel_, {emitted_, means_, received_}, received, all);
}

void GlobalIntrinsic::measure_amount(gpu::Commands& commands, const Params& params) {
  const struct {
    Place place;
    float least, ratio, neutral;
  } amount{place(), kLeastAmount, kAmountRatio, 1 / (2 * kNeutralWidth * kNeutralWidth)};
  commands.dispatch(amount_, {colors_, points_, labels_, received_, candidates_}, amount,
                    line_of(grid_.pixels()));
  const struct {
    float ln_least, ln_ratio, neutral, ln_typical, spread, trust, manual;
  } weigh{std::log(kLeastAmount), std::log(kAmountRatio), params.neutral, std::log(params.typical),
          params.spread,          params.trust,           params.amount};
  commands.dispatch(weigh_, {candidates_, scene_}, weigh, {});
}

void GlobalIntrinsic::find_tint(gpu::Commands& commands, const Params& params) {
  commands.dispatch(tint_, {colors_, points_, labels_, received_, scene_, counts_, tints_, sums_},
                    place(), line_of(grid_.pixels()));
  const struct {
    int32_t count;
    float gate, residual;
  } statistics{static_cast<int32_t>(sums_->count()), kGate, params.residual};
  commands.dispatch(statistics_, {sums_, scene_}, statistics, {});
}

void GlobalIntrinsic::find_colors(gpu::Commands& commands, const Params& params) {
  const struct {
    float smoothing, least_share, same;
    int32_t most;
  } modes{params.smoothing, params.least_share, params.same_color, params.base_colors};
  commands.dispatch(modes_, {counts_, scene_, slots_, histogram_, heights_, work_}, modes, {});
}

PlanePtr GlobalIntrinsic::look(gpu::Commands& commands, const PlanePtr& frame, const Params& params,
                               bool plain) {
  const struct {
    Place place;
    float gauge;
  } grid{place(), params.gauge.value};
  const auto make_grid = [&](size_t raw) {
    commands.dispatch(plain ? plain_grid_ : grid_kernel_[raw],
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
    look_at(look_);
    return nullptr;
  }
  make_grid(1);
  look_at(decide_);
  PlanePtr lamp = lamps_.acquire();
  const struct {
    int32_t count;
    float share;
  } white{count, params.white_balance};
  commands.dispatch(white_, {colors_, scene_, lamp->buffer}, white, {});
  make_grid(0);
  look_at(start_);
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
  commands.dispatch(believe_, {points_, tints_, slots_, scene_, labels_, raw_}, believe, points);
  const struct {
    uint32_t grid[2];
    int32_t radius;
    float edge;
  } fit{{grid_.width, grid_.height},
        std::max(1, static_cast<int32_t>(std::lround(kWindow * static_cast<float>(grid_.width)))),
        kEdge};
  for (size_t pass = 0; pass < 3; ++pass)
    commands.dispatch(fit_[pass], {raw_, pass == 0 ? raw_ : fits_[pass - 1], fits_[pass]}, fit,
                      points);
}

uint32_t GlobalIntrinsic::planes_needed(const Params& params) const {
  uint32_t slots = static_cast<uint32_t>(params.base_colors);
  // Colors keep their slots, and new ones take the lowest: what the last frame that is sure to be
  // done had says what this one needs. Light of a color beyond counts to the others for so long.
  if (frames_ >= reports_.size()) slots = report(recorded_ - reports_.size()).slots();
  return std::clamp((slots + 3) / 4, 1U, kIndirectPlanes);
}

bool GlobalIntrinsic::colorless(const Params& params) {
  // The lamps' color may be all that there is.
  if (params.amount > 0 || params.white_balance > 0) gray_ = 0;
  // Judged by the last frame that is sure to be done, so that the same video always gives the same.
  if (frames_ < reports_.size() || params.amount > 0 || params.white_balance > 0) return false;
  const bool usable = report(recorded_ - reports_.size()).found->map_as<float>()[kUsable / 4] > 0;
  gray_ = usable ? 0 : std::min(gray_ + 1, kRest);
  return gray_ == kRest;
}

PlanePtr GlobalIntrinsic::white_light(gpu::Commands& commands) {
  if (!white_light_) {
    white_light_ = std::make_shared<Plane>(
        Plane{extent_, gpu::Buffer::create(device_, gpu::Element::vec4, extent_.pixels())});
    commands.fill(white_light_->buffer, std::bit_cast<uint32_t>(1.0F));
  }
  return white_light_;
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

uint32_t GlobalIntrinsic::Report::slots() const {
  const float* colors = found->map_as<float>() + 4 * size_t{kSceneColors};
  uint32_t slots = 0;
  for (uint32_t k = 0; k < kSlots; ++k)
    if (colors[4 * k + 2] > 0) slots = k + 1;
  return slots;
}

void GlobalIntrinsic::share_out(gpu::Commands& commands, Layers& layers, uint32_t count) {
  for (uint32_t n = 0; n < count; ++n) layers[indirect_role(n)] = planes_.acquire();
  const auto share = [&](uint32_t n) { return layers[indirect_role(n < count ? n : 0)]->buffer; };
  commands.dispatch(
      device_->kernel(shaders::global_shares, {count}),
      {layers[Role::input]->buffer, tints_, slots_, fields_, layers[Role::bases]->buffer,
       layers[Role::light]->buffer, scene_, share(0), share(1), share(2), share(3)},
      place(), pixels_of(extent_));
  commands.stage("shares");
}

Layers GlobalIntrinsic::record(gpu::Commands& commands, const PlanePtr& input, const Params& asked,
                               const FrameInfo& info) {
  const Params params = within_ranges(asked);
  if (info.reset) reset();
  const bool first = frames_ == 0;
  if (first)  // some of it is read before it is written, though not used
    for (const auto& cleared : {memory_, before_, labels_, sums_, scene_, histogram_})
      commands.fill(cleared);
  if (reach_ != params.reach) make_taps(params);
  const bool plain = colorless(params);
  const PlanePtr lamp = look(commands, input, params, plain);
  commands.stage("grid");
  Report& report = reports_[recorded_ % reports_.size()];
  if (!report.found)
    report.found =
        gpu::Buffer::create(device_, gpu::Element::vec4, kSceneSize, gpu::Memory::readback);
  Layers layers;
  if (plain) {
    layers = solve_.record(commands, input, params, {false, info.changed});
    layers[Role::light] = layers[Role::model_light] = white_light(commands);
  } else {
    white_light_.reset();
    find_scene(commands, params);
    layers = record_light(commands, input, params, info.shares);
    layers[Role::lamp] = lamp;
  }
  commands.copy(scene_, report.found, report.found->bytes());
  report.solve = solve_.recorded() - 1;
  report.stats = {solve_.stats(report.solve), first, plain};
  if (plain)
    report.stats.solve.skipped.emplace_back("indirect light: the scene has no color to go by");
  commands.keep(layers[Role::light]);
  ++recorded_;
  ++frames_;
  return layers;
}

Layers GlobalIntrinsic::record_light(gpu::Commands& commands, const PlanePtr& input,
                                     const Params& params, bool shares) {
  const Place here = place();
  const PlanePtr plain = planes_.acquire(), light = planes_.acquire();
  const struct {
    Place place;
    float gauge, trust, trust_tint;
  } untint{here, params.gauge.value, kTrust, kTrustTint};
  commands.dispatch(untint_,
                    {input->buffer, memory_, tints_, slots_, received_, fits_[0], fits_[2], scene_,
                     plain->buffer, light->buffer},
                    untint, {(extent_.width + 3) / 4, extent_.height});
  commands.stage("untint");
  const uint32_t planes = shares ? planes_needed(params) : 0;
  const PlanePtr bases = planes > 0 ? bases_.acquire() : nullptr;
  if (bases) {
    if (!fields_)
      fields_ = gpu::Buffer::create(device_, gpu::Element::vec4, coarse_.pixels() * 4 * kSlots);
    gather(commands, params, true);  // of the frame's own base colors
    const struct {
      Place place;
      float near, own;
    } push{here, params.near, params.own};
    commands.dispatch(fields_kernel_, {emitted_, means_, received_, scene_, fields_, bases->buffer},
                      push, line_of(coarse_.pixels() * kSlots));
  }

  Layers layers = solve_.record(commands, plain, params, {false, {}});
  const PlanePtr& intrinsic = layers[Role::intrinsic];
  commands.dispatch(direct_, {plain->buffer, intrinsic->buffer, scene_, light->buffer, memory_},
                    std::array<uint32_t, 2>{extent_.width, extent_.height}, pixels_of(extent_));
  commands.stage("direct");
  layers[Role::input] = input;
  layers[Role::light] = layers[Role::model_light] = light;
  if (bases) {
    layers[Role::bases] = layers[Role::model_bases] = bases;
    share_out(commands, layers, planes);
  }
  commands.keep(input);
  commands.keep(plain);
  return layers;
}

GlobalIntrinsic::Findings GlobalIntrinsic::findings(uint64_t frame) const {
  const Report& of = report(frame);
  const float* found = of.found->map_as<float>();
  const auto slot = [&](uint32_t k) { return found + 4 * size_t{k}; };
  Findings findings{solve_.findings(of.solve), slot(kSceneAmount)[0],
                    slot(kSceneAmount)[1],     static_cast<uint32_t>(slot(kSceneAmount)[3]),
                    slot(kSceneTint)[0],       slot(kSceneTime)[0] > 0,
                    slot(kSceneTint)[3]};
  for (uint32_t k = 0; k < kSlots; ++k) {
    const float* color = slot(kSceneColors + k);
    if (!(color[2] > 0)) continue;
    // color_of in model.glsl
    const float u = 0.70710678F * color[0], v = 0.40824829F * color[1];
    const float most = std::max({v + u, v - u, -2 * v});
    findings.bases[k] = {std::exp(v + u - most), std::exp(v - u - most), std::exp(-2 * v - most)};
  }
  return findings;
}

}  // namespace inverse
