// SPDX-License-Identifier: LGPL-2.1-or-later
#include "global_intrinsic.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "global_model.hpp"
#include "kernels/gpu/reduce.hpp"

namespace inverse {

using namespace global_model;

namespace {

constexpr uint32_t kMostPoints = 40;  // along the longer side of the grid
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
  keep(params.base_colors, 1, Model::kSlots);
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
      factor_(static_cast<int32_t>(factor_for(extent))),
      solve_(device_, extent),
      planes_(device_, extent),
      bases_(device_, {kMaxBases, 1}),
      lamps_(device_, {1, 1}) {
  grid_ = reduced(extent_, factor_for(extent_));
  coarse_ = reduced(grid_, 2);
  const uint32_t lanes = device_->variant().lone_workgroup;
  kernels_.tint = {device_};
  kernels_.white = {device_, {}, lanes};
  kernels_.decide_and_start = {device_, {}, lanes};
  kernels_.decide = {device_, {.start = false}, lanes};
  kernels_.start = {device_, {.decide = false}, lanes};
  // Where points are eight pixels apart, four aligned ones lie between the same.
  kernels_.untint = {device_, {.wide = factor_ >= 8}, 4, 16};
  kernels_.summary = {device_, {}, lanes};
  kernels_.received = {device_};
  kernels_.amount = {device_};
  kernels_.statistics = {device_, {}, lanes};
  kernels_.fields = {device_};
  kernels_.believe = {device_};
  kernels_.direct = {device_, {}, 4, 16};
  kernels_.weigh = {device_, {}, lanes};
  kernels_.modes = {device_, {}, lanes};
  for (const bool k : {false, true}) {
    kernels_.grid[k] = {device_, {.raw = k}};
    kernels_.emit[k] = {device_, {.known = k}};
    kernels_.blur[k] = {device_, {.down = k}};
  }
  kernels_.plain_grid = {device_, {.plain = true}};
  for (const uint32_t pass : {0U, 1U, 2U}) kernels_.fit[pass] = {device_, {.pass = pass}};

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
    *plane = buffer(Element::vec4, coarse * Model::kSlots);
  means_ = buffer(Element::vec4, Model::kSlots);
  candidates_ = buffer(Element::word, Model::kCandidates * (Model::kBinCount + 2));
  counts_ = buffer(Element::word, Model::kBinCount);
  histogram_ = buffer(Element::scalar, Model::kBinCount);
  heights_ = buffer(Element::scalar, uint64_t{2} * Model::kBinCount);
  work_ = buffer(Element::word,
                 shaders::global_scene_modes::kListed + shaders::global_scene_modes::kMostListed);
  slots_ = buffer(Element::word, Model::kBinCount);
  sums_ = buffer(Element::vec4, gpu::partial_count(*kernels_.tint.kernel(), line_of(points)));
  scene_ = buffer(Element::vec4, Model::SCENE_SIZE);
}

void GlobalIntrinsic::reset() {
  solve_.reset();
  frames_ = 0;
  gray_ = calm_ = 0;
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
  const auto& list = changed_[recorded_];
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
  const float* colors = found->map_as<float>() + 4 * size_t{Model::SCENE_COLORS};
  uint32_t slots = 0;
  for (uint32_t k = 0; k < Model::kSlots; ++k)
    if (colors[4 * k + 2] > 0) slots = k + 1;
  return slots;
}

void GlobalIntrinsic::share_out(gpu::Commands& commands, Layers& layers, uint32_t count) {
  for (uint32_t n = 0; n < count; ++n) layers[indirect_role(n)] = planes_.acquire();
  const auto share = [&](uint32_t n) -> gpu::Out {
    if (n < count) return layers[indirect_role(n)]->buffer;
    return gpu::aliased(layers[indirect_role(0)]->buffer);  // it is not written
  };
  commands.dispatch(
      gpu::Program<shaders::global_light_shares>(device_, {.planes = static_cast<int32_t>(count)}),
      {.frame = layers[Role::input]->buffer,
       .tints = tints_,
       .slots = slots_,
       .fields = fields_,
       .bases = layers[Role::bases]->buffer,
       .light = layers[Role::light]->buffer,
       .scene = scene_,
       .share0 = share(0),
       .share1 = share(1),
       .share2 = share(2),
       .share3 = share(3)},
      sizes(), pixels_of(extent_));
  commands.stage("shares");
}

void GlobalIntrinsic::draw_labels(gpu::Commands& commands, const Plane& input,
                                  const Plane& target) {
  commands.dispatch(gpu::Program<shaders::global_light_labels>(device_),
                    {.frame = input.buffer,
                     .tints = tints_,
                     .slots = slots_,
                     .scene = scene_,
                     .picture = target.buffer},
                    sizes(), pixels_of(extent_));
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
  Report& report = reports_[recorded_];
  if (!report.found)
    report.found =
        gpu::Buffer::create(device_, gpu::Element::vec4, Model::SCENE_SIZE, gpu::Memory::readback);
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
  kernels_.untint.dispatch(commands, mode_ == Tint::held ? &*changed_[recorded_] : nullptr,
                           {.frame = input->buffer,
                            .memory = memory_,
                            .tints = tints_,
                            .slots = slots_,
                            .received = received_,
                            .smooth_part = fits_[0],
                            .coefficients = fits_[2],
                            .scene = scene_,
                            .plain = plain->buffer,
                            .light = tau->buffer},
                           {.size = extent_,
                            .grid = grid_,
                            .coarse = coarse_,
                            .factor = factor_,
                            .white_level = params.scale.white_level,
                            .trust = kTrust,
                            .trust_tint = kTrustTint},
                           fours_of(extent_));
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
  kernels_.direct.dispatch(commands, drawn_,
                           {.frame = plain->buffer,
                            .intrinsic = layers[Role::intrinsic]->buffer,
                            .scene = scene_,
                            .tau = gpu::aliased(tau->buffer),
                            .light = light->buffer,
                            .memory = memory_},
                           {.size = extent_}, fours_of(extent_));
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
      fields_ =
          gpu::Buffer::create(device_, gpu::Element::vec4, coarse_.pixels() * 4 * Model::kSlots);
      known_ = gpu::Buffer::create(device_, gpu::Element::vec4, coarse_.pixels() * Model::kSlots);
    }
    gather(commands, params, true);  // of the frame's own base colors
    commands.dispatch(kernels_.fields,
                      {.blurred = emitted_,
                       .means = means_,
                       .received = known_,
                       .scene = scene_,
                       .fields = fields_,
                       .bases = bases->buffer},
                      {.size = extent_,
                       .grid = grid_,
                       .coarse = coarse_,
                       .factor = factor_,
                       .near = params.near,
                       .own = params.own},
                      line_of(coarse_.pixels() * Model::kSlots));
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
  Findings findings{
      solve_.findings(of.solve),    slot(Model::SCENE_AMOUNT)[0],
      slot(Model::SCENE_AMOUNT)[1], static_cast<uint32_t>(slot(Model::SCENE_AMOUNT)[3]),
      slot(Model::SCENE_TINT)[0],   slot(Model::SCENE_TIME)[0] > 0,
      slot(Model::SCENE_TINT)[3]};
  for (uint32_t k = 0; k < Model::kSlots; ++k) {
    const float* color = slot(Model::SCENE_COLORS + k);
    if (!(color[2] > 0)) continue;
    // color_of in model.glsl
    const float u = 0.70710678F * color[0], v = 0.40824829F * color[1];
    const float most = std::max({v + u, v - u, -2 * v});
    findings.bases[k] = {std::exp(v + u - most), std::exp(v - u - most), std::exp(-2 * v - most)};
  }
  return findings;
}

}  // namespace inverse
