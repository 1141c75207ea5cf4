#include "global_intrinsic.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "global_model.hpp"
#include "kernels/gpu/reduce.hpp"
#include "kernels/gpu/shaders.hpp"

INVERSE_SHADER(global_scene_amount);
INVERSE_SHADER(global_light_believe);
INVERSE_SHADER(global_gather_blur);
INVERSE_SHADER(global_light_direct);
INVERSE_SHADER(global_gather_emit);
INVERSE_SHADER(global_gather_fields);
INVERSE_SHADER(global_light_fit);
INVERSE_SHADER(global_grid_grid);
INVERSE_SHADER(global_light_labels);
INVERSE_SHADER(global_grid_look);
INVERSE_SHADER(global_scene_modes);
INVERSE_SHADER(global_gather_received);
INVERSE_SHADER(global_light_shares);
INVERSE_SHADER(global_scene_statistics);
INVERSE_SHADER(global_gather_summary);
INVERSE_SHADER(global_scene_tint);
INVERSE_SHADER(global_light_untint);
INVERSE_SHADER(global_scene_weigh);
INVERSE_SHADER(global_grid_white);

namespace inverse {

using namespace global_model;

namespace {

constexpr uint64_t kWorkWords = 4 * kBinCount + 1 + 1024;  // modes.comp
constexpr uint32_t kMostPoints = 40;                       // along the longer side of the grid
/// Frames for which light is held, or until how many tiles have changed in that time. After that it
/// is looked at for some frames.
constexpr uint32_t kHeld = 64, kLook = 4;
constexpr float kMostSeen = 0.4F;

using Changed = std::span<const uint8_t>;

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
  keep(params.full_trust, 0.01F, 10.0F);
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

/// Invocations for four pixels side by side each.
gpu::Items fours_of(Extent extent) {
  return line_of((extent.width + uint64_t{3}) / 4 * extent.height);
}

/// Whether light is found in the same way, whatever work goes into the solve.
bool same_light(GlobalIntrinsic::Params a, const GlobalIntrinsic::Params& b) {
  static_cast<ScaledIntrinsic::Params&>(a) = b;
  return a == b;
}

}  // namespace

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
  kernels_.tint = device_->kernel(shaders::global_scene_tint);
  kernels_.white = device_->kernel(shaders::global_grid_white, {}, lanes);
  kernels_.decide_and_start = device_->kernel(shaders::global_grid_look, {1, 1}, lanes);
  kernels_.decide = device_->kernel(shaders::global_grid_look, {1, 0}, lanes);
  kernels_.start = device_->kernel(shaders::global_grid_look, {0, 1}, lanes);
  // Where points are eight pixels apart, four aligned ones lie between the same.
  kernels_.untint = {device_, shaders::global_light_untint, {factor_ >= 8 ? 1U : 0U}, 4, 16};
  kernels_.summary = device_->kernel(shaders::global_gather_summary, {}, lanes);
  kernels_.received = device_->kernel(shaders::global_gather_received);
  kernels_.amount = device_->kernel(shaders::global_scene_amount);
  kernels_.statistics = device_->kernel(shaders::global_scene_statistics, {}, lanes);
  kernels_.fields = device_->kernel(shaders::global_gather_fields);
  kernels_.believe = device_->kernel(shaders::global_light_believe);
  kernels_.direct = {device_, shaders::global_light_direct, {}, 4, 16};
  kernels_.weigh = device_->kernel(shaders::global_scene_weigh, {}, lanes);
  kernels_.modes = device_->kernel(shaders::global_scene_modes, {}, lanes);
  for (const uint32_t k : {0U, 1U}) {
    kernels_.grid[k] = device_->kernel(shaders::global_grid_grid, {k});
    kernels_.emit[k] = device_->kernel(shaders::global_gather_emit, {k});
    kernels_.blur[k] = device_->kernel(shaders::global_gather_blur, {k});
  }
  kernels_.plain_grid = device_->kernel(shaders::global_grid_grid, {0, 1});
  for (const uint32_t pass : {0U, 1U, 2U})
    kernels_.fit[pass] = device_->kernel(shaders::global_light_fit, {pass});

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
  sums_ = buffer(Element::vec4, gpu::partial_count(*kernels_.tint, line_of(points)));
  scene_ = buffer(Element::vec4, kSceneSize);
}

void GlobalIntrinsic::reset() {
  solve_.reset();
  frames_ = 0;
  gray_ = calm_ = 0;
}

GlobalIntrinsic::Place GlobalIntrinsic::place() const {
  return {{extent_.width, extent_.height},
          {grid_.width, grid_.height},
          {coarse_.width, coarse_.height},
          factor_};
}

GlobalIntrinsic::Tint GlobalIntrinsic::next_tint(const Params& params, const FrameInfo& info) {
  const bool same = same_light(std::exchange(params_, params), params);
  const auto forget = [&](uint32_t calm) {
    calm_ = calm;
    kept_plain_ = kept_tau_ = kept_light_ = kept_lamp_ = kept_bases_ = nullptr;
    return Tint::anew;
  };
  if (!params.adaptive || !same || frames_ == 0 || info.changed.empty()) return forget(0);
  // Chroma is interpolated: what changed shows a pixel further.
  const auto& list = changed_[recorded_ % changed_.size()];
  concerned_ = spread_tiles(info.changed, list->columns());
  const auto share_of = [](const std::vector<uint8_t>& tiles) {
    return static_cast<float>(std::count(tiles.begin(), tiles.end(), 1)) /
           static_cast<float>(tiles.size());
  };
  if (share_of(concerned_) > kMostChanged) return forget(0);
  if (++calm_ < kCalm) return forget(calm_);
  if (calm_ == kCalm) {
    seen_.assign(concerned_.size(), 0);
    return Tint::kept;
  }
  for (size_t i = 0; i < seen_.size(); ++i) seen_[i] |= concerned_[i];
  if (calm_ > kCalm + kHeld || share_of(seen_) > kMostSeen) return forget(kCalm - kLook);
  list->assign(concerned_);
  return Tint::held;
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
      device_->kernel(shaders::global_light_shares, {count}),
      {layers[Role::input]->buffer, tints_, slots_, fields_, layers[Role::bases]->buffer,
       layers[Role::light]->buffer, scene_, share(0), share(1), share(2), share(3)},
      place(), pixels_of(extent_));
  commands.stage("shares");
}

void GlobalIntrinsic::draw_labels(gpu::Commands& commands, const Plane& input,
                                  const Plane& target) {
  commands.dispatch(device_->kernel(shaders::global_light_labels),
                    {input.buffer, tints_, slots_, scene_, target.buffer}, place(),
                    pixels_of(extent_));
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
  const bool was_plain = rested_, plain = colorless(params);
  if (!changed_[0] && !info.changed.empty())
    for (auto& list : changed_) list.emplace(device_, extent_, gpu::Memory::upload);
  mode_ = next_tint(params, plain ? FrameInfo{} : info);
  PlanePtr lamp = kept_lamp_;
  if (mode_ != Tint::held) {
    lamp = look(commands, input, params, plain);
    commands.stage("grid");
  }
  Report& report = reports_[recorded_ % reports_.size()];
  if (!report.found)
    report.found =
        gpu::Buffer::create(device_, gpu::Element::vec4, kSceneSize, gpu::Memory::readback);
  Layers layers;
  if (plain) {
    // The frame before may have been of another tint.
    layers = solve_.record(commands, input, params, {false, was_plain ? info.changed : Changed{}});
    layers[Role::light] = layers[Role::model_light] = white_light(commands);
    drawn_ = was_plain ? solve_.drawn() : nullptr;
  } else {
    white_light_.reset();
    if (mode_ != Tint::held) find_scene(commands, params);
    if (mode_ == Tint::kept) kept_lamp_ = lamp;
    layers = record_light(commands, input, params, info);
    layers[Role::lamp] = lamp;
  }
  commands.copy(scene_, report.found, report.found->bytes());
  report.solve = solve_.recorded() - 1;
  report.stats = {solve_.stats(report.solve), first, plain, mode_ == Tint::held};
  if (plain)
    report.stats.solve.skipped.emplace_back("indirect light: the scene has no color to go by");
  if (mode_ == Tint::held)
    report.stats.solve.skipped.emplace_back("scene: little has changed since it was looked at");
  commands.keep(layers[Role::light]);
  ++recorded_;
  ++frames_;
  return layers;
}

void GlobalIntrinsic::record_tint(gpu::Commands& commands, const PlanePtr& input,
                                  const Params& params, const PlanePtr& plain,
                                  const PlanePtr& tau) {
  const struct {
    Place place;
    float white_level, trust, trust_tint;
  } push{place(), params.scale.white_level, kTrust, kTrustTint};
  kernels_.untint.dispatch(commands,
                           mode_ == Tint::held ? &*changed_[recorded_ % changed_.size()] : nullptr,
                           {input->buffer, memory_, tints_, slots_, received_, fits_[0], fits_[2],
                            scene_, plain->buffer, tau->buffer},
                           push, fours_of(extent_));
  commands.stage("untint");
}

PlanePtr GlobalIntrinsic::record_direct(gpu::Commands& commands, const PlanePtr& plain,
                                        const PlanePtr& tau, const Layers& layers) {
  // Where light is that of the frame before, so is its direct share but where shading has moved.
  drawn_ = mode_ == Tint::held ? solve_.drawn() : nullptr;
  PlanePtr light = mode_ == Tint::anew ? tau : nullptr;
  if (drawn_ && kept_light_.use_count() == 1) light = kept_light_;
  if (!light) {
    light = planes_.acquire();
    if (drawn_) commands.copy(kept_light_->buffer, light->buffer, light->buffer->bytes());
  }
  kernels_.direct.dispatch(
      commands, drawn_,
      {plain->buffer, layers[Role::intrinsic]->buffer, scene_, tau->buffer, light->buffer, memory_},
      std::array<uint32_t, 2>{extent_.width, extent_.height}, fours_of(extent_));
  commands.stage("direct");
  if (mode_ != Tint::anew) kept_light_ = light;
  return light;
}

Layers GlobalIntrinsic::record_light(gpu::Commands& commands, const PlanePtr& input,
                                     const Params& params, const FrameInfo& info) {
  if (mode_ == Tint::kept) {
    kept_plain_ = planes_.acquire();
    kept_tau_ = planes_.acquire();
  }
  const PlanePtr plain = mode_ == Tint::anew ? planes_.acquire() : kept_plain_,
                 tau = mode_ == Tint::anew ? planes_.acquire() : kept_tau_;
  record_tint(commands, input, params, plain, tau);
  const uint32_t planes = info.shares ? planes_needed(params) : 0;
  PlanePtr bases = planes > 0 ? kept_bases_ : nullptr;
  if (planes > 0 && !bases) {
    bases = bases_.acquire();
    if (!fields_) {
      fields_ = gpu::Buffer::create(device_, gpu::Element::vec4, coarse_.pixels() * 4 * kSlots);
      known_ = gpu::Buffer::create(device_, gpu::Element::vec4, coarse_.pixels() * kSlots);
    }
    gather(commands, params, true);  // of the frame's own base colors
    const struct {
      Place place;
      float near, own;
    } push{place(), params.near, params.own};
    commands.dispatch(kernels_.fields, {emitted_, means_, known_, scene_, fields_, bases->buffer},
                      push, line_of(coarse_.pixels() * kSlots));
    if (mode_ != Tint::anew) kept_bases_ = bases;
  }

  // Of tiles concerned the solve's input is another up to their far side.
  Layers layers =
      solve_.record(commands, plain, params, {false, mode_ == Tint::held ? concerned_ : Changed{}});
  const PlanePtr light = record_direct(commands, plain, tau, layers);
  layers[Role::input] = input;
  layers[Role::light] = layers[Role::model_light] = light;
  if (bases) {
    layers[Role::bases] = layers[Role::model_bases] = bases;
    share_out(commands, layers, planes);
  }
  commands.keep(input);
  commands.keep(plain);
  commands.keep(tau);
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
