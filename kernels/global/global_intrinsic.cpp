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

constexpr uint32_t kMaxPoints = 40;  // along the longer side of the grid

Extent reduced(Extent extent, uint32_t factor) {
  return {(extent.width + factor - 1) / factor, (extent.height + factor - 1) / factor};
}

uint32_t factor_for(Extent extent) {
  uint32_t factor = 1;
  while (std::max(reduced(extent, factor).width, reduced(extent, factor).height) > kMaxPoints)
    factor *= 2;
  return factor;
}

GlobalIntrinsic::Params within_ranges(GlobalIntrinsic::Params params) {
  const auto clamp = [](auto& value, auto low, auto high) {
    value = value > low ? std::min(value, high) : low;  // NaN becomes low
  };
  clamp(params.reach, 0.02F, 2.0F);
  clamp(params.near_share, 0.0F, 1.0F);
  clamp(params.own, 0.0F, 0.95F);
  clamp(params.amount, 0.0F, 2.0F);
  clamp(params.neutral, 0.0F, 100.0F);
  clamp(params.typical_amount, 0.05F, 2.0F);
  clamp(params.spread, 0.05F, 10.0F);
  clamp(params.measurement_weight, 0.0F, 100.0F);
  clamp(params.full_spread, 0.01F, 10.0F);
  clamp(params.base_colors, 1, Model::kSlots);
  clamp(params.min_share, 0.0F, 0.5F);
  clamp(params.same_color, 0.0F, 10.0F);
  clamp(params.update_rate, 0.01F, 1.0F);
  clamp(params.white_balance, 0.0F, 1.0F);
  clamp(params.cut_chroma, 0.0F, 1.0F);
  clamp(params.smoothing, 0.5F, 2.5F);
  clamp(params.residual, 0.0F, 1.0F);
  clamp(params.no_color, 0.0F, 1.0F);
  clamp(params.full_color, params.no_color + 1e-3F, 2.0F);
  return params;
}

/// Invocations for four horizontally adjacent pixels each.
gpu::Rows fours_of(Extent extent) { return {pack4_count(extent.width), extent.height, 1, true}; }

/// Whether both find light in the same way; the parameters of the solve do not count.
bool same_light(GlobalIntrinsic::Params a, const GlobalIntrinsic::Params& b) {
  static_cast<ScaledIntrinsic::Params&>(a) = b;
  return a == b;
}

}  // namespace

GlobalIntrinsic::GlobalIntrinsic(std::shared_ptr<gpu::Device> device, Extent extent)
    : device_(std::move(device)),
      extent_(extent),
      factor_(static_cast<int32_t>(factor_for(extent))),
      light_color_(device_, extent),
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
  // If points are eight pixels apart, four aligned pixels lie between the same ones.
  kernels_.divide_tint = {device_, {.wide = factor_ >= 8}};
  kernels_.summary = {device_, {}, lanes};
  kernels_.received = {device_};
  kernels_.amount = {device_};
  kernels_.statistics = {device_, {}, lanes};
  kernels_.fields = {device_};
  kernels_.label_confidence = {device_};
  kernels_.direct = {device_};
  kernels_.weigh = {device_, {}, lanes};
  kernels_.modes = {device_, {}, lanes};
  const uint32_t point_lanes = device_->variant().area_workgroup();
  for (const bool k : {false, true}) {
    kernels_.grid[k] = {device_, {.raw = k}, point_lanes};
    kernels_.emit[k] = {device_, {.known = k}};
    kernels_.blur[k] = {device_, {.down = k}};
  }
  kernels_.color_grid = {device_, {.plain = true}, point_lanes};
  for (const uint32_t pass : {0U, 1U, 2U}) kernels_.fit[pass] = {device_, {.pass = pass}};
  for (uint32_t k = 0; k < kIndirectPlanes; ++k)
    kernels_.shares[k] = {device_, {.planes = static_cast<int32_t>(k + 1)}};

  using gpu::Buffer;
  using gpu::Element;
  const uint64_t points = grid_.pixels(), coarse = coarse_.pixels();
  const auto buffer = [&](Element element, uint64_t count) {
    return Buffer::create(device_, element, count);
  };
  memory_ = Buffer::create_by_rows(device_, Element::scalar, extent_.pixels());
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
                 shaders::global_scene_modes::kListed + shaders::global_scene_modes::kMaxListed);
  slots_ = buffer(Element::word, Model::kBinCount);
  sums_ = buffer(Element::vec4, gpu::partial_count(*kernels_.tint.kernel(), line_of(points)));
  scene_ = buffer(Element::vec4, Model::SCENE_SIZE);
  gray_light_ = buffer(Element::vec4, Model::LIGHT_SIZE);
}

void GlobalIntrinsic::reset() {
  solve_.reset();
  frames_ = 0;
  planner_.reset();
}

LightPlanner::Plan GlobalIntrinsic::plan_light(const Params& params, const FrameInfo& info) {
  LightPlanner::Frame frame{.adaptive = params.adaptive,
                            .first = frames_ == 0,
                            .same_params = same_light(std::exchange(params_, params), params),
                            // Used if there are no other colors.
                            .light_asked = params.amount > 0 || params.white_balance > 0,
                            .repeated = info.repeated};
  // By the last frame that is sure to be done, so that the same video always gets the same plans.
  if (frames_ >= reports_.size())
    frame.had_color =
        report(recorded_ - reports_.size()).found->map_as<float>()[kUsable / sizeof(float)] > 0;
  return planner_.next(frame);
}

uint32_t GlobalIntrinsic::planes_needed(const Params& params) const {
  uint32_t slots = static_cast<uint32_t>(params.base_colors);
  // Colors keep their slots, and new ones take the lowest: the last frame that is sure to be done
  // has the number. Until then, light of a new color counts to the others.
  if (frames_ >= reports_.size()) slots = report(recorded_ - reports_.size()).slots();
  return std::clamp((slots + 3) / 4, 1U, kIndirectPlanes);
}

void GlobalIntrinsic::measure_light_color(gpu::Commands& commands, const Plane& input,
                                          const Params& params) {
  colored_ = params.light.colored();
  if (!colored_) return light_color_.restart();
  light_color_.record(commands, input.buffer, params.light, frames_ == 0);
  // Without color in the frame only the solve may reuse something.
  if (!plan_.gray) light_color_.record_move(commands, plan_.reused());
  commands.stage("light-color");
}

PlanePtr GlobalIntrinsic::white_light(gpu::Commands& commands) {
  if (!white_light_) {
    white_light_ = std::make_shared<Plane>(
        Plane{extent_, gpu::Buffer::create_by_rows(device_, gpu::Element::vec4, extent_.pixels())});
    commands.fill(white_light_->buffer, std::bit_cast<uint32_t>(1.0F));
  }
  return white_light_;
}

uint32_t GlobalIntrinsic::Report::slots() const {
  const float* colors = found->map_as<float>() + 4 * size_t{Model::SCENE_COLORS};
  uint32_t slots = 0;
  for (uint32_t k = 0; k < Model::kSlots; ++k)
    if (colors[4 * k + Model::COLOR_USED] > 0) slots = k + 1;
  return slots;
}

void GlobalIntrinsic::share_out(gpu::Commands& commands, Layers& layers, uint32_t count) {
  for (uint32_t n = 0; n < count; ++n) layers[indirect_role(n)] = planes_.acquire();
  const auto share = [&](uint32_t n) -> gpu::Out {
    if (n < count) return gpu::by_rows(layers[indirect_role(n)]->buffer);
    return gpu::by_rows(gpu::aliased(layers[indirect_role(0)]->buffer));  // it is not written
  };
  commands.dispatch_rows(kernels_.shares[count - 1],
                         {.frame = layers[Role::input]->buffer,
                          .tints = tints_,
                          .slots = slots_,
                          .fields = fields_,
                          .bases = layers[Role::bases]->buffer,
                          .light = layers[Role::light]->buffer,
                          .scene = scene_,
                          .light_state = light_state(),
                          .share0 = share(0),
                          .share1 = share(1),
                          .share2 = share(2),
                          .share3 = share(3)},
                         row_sizes(), {extent_.width, extent_.height});
  commands.stage("shares");
}

void GlobalIntrinsic::draw_labels(gpu::Commands& commands, const Plane& input,
                                  const Plane& target) {
  commands.dispatch_rows(gpu::Program<shaders::global_light_labels>(device_),
                         {.frame = input.buffer,
                          .tints = tints_,
                          .slots = slots_,
                          .scene = scene_,
                          .light_state = light_state(),
                          .picture = gpu::by_rows(target.buffer)},
                         row_sizes(), {extent_.width, extent_.height});
}

Layers GlobalIntrinsic::record(gpu::Commands& commands, const PlanePtr& input, const Params& asked,
                               const FrameInfo& info) {
  const Params params = within_ranges(asked);
  if (info.reset) reset();
  const bool first = frames_ == 0, was_gray = plan_.gray;
  if (first)  // some of it is read before it is written, though not used
    for (const auto& cleared : {memory_, before_, labels_, sums_, scene_, histogram_, gray_light_})
      commands.fill(cleared);
  if (reach_ != params.reach) make_taps(params);
  plan_ = plan_light(params, info);
  measure_light_color(commands, *input, params);
  if (plan_.light == LightPlanner::Light::measure) kept_ = {};
  PlanePtr lamp = kept_.lamp;
  if (!plan_.reused()) {
    lamp = measure_grid(commands, input, params, was_gray);
    commands.stage("grid");
    if (!plan_.gray) find_scene(commands, params);
  }
  if (plan_.light == LightPlanner::Light::measure_keep) kept_.lamp = lamp;
  Layers layers = plan_.gray ? record_gray(commands, input, params, info)
                             : record_light(commands, input, params, info);
  if (!plan_.gray) layers[Role::lamp] = lamp;
  record_report(commands, first);
  commands.keep(layers[Role::light]);
  return layers;
}

void GlobalIntrinsic::record_report(gpu::Commands& commands, bool first) {
  Report& report = reports_[recorded_];
  if (!report.found)
    report.found =
        gpu::Buffer::create(device_, gpu::Element::vec4, Model::SCENE_SIZE, gpu::Memory::readback);
  commands.copy(scene_, report.found, report.found->bytes());
  report.solve = solve_.recorded() - 1;
  report.stats = {solve_.stats(report.solve), first, plan_};
  ++recorded_;
  ++frames_;
}

Layers GlobalIntrinsic::record_gray(gpu::Commands& commands, const PlanePtr& input,
                                    const Params& params, const FrameInfo& info) {
  Layers layers = solve_.record(commands, input, params,
                                {.repeated = info.repeated,
                                 .light = colored_light(),
                                 .strokes = info.strokes,
                                 .tracker = info.tracker,
                                 .seen = info.seen,
                                 .known = info.known});
  layers[Role::light] = layers[Role::model_light] = white_light(commands);
  return layers;
}

void GlobalIntrinsic::record_tint(gpu::Commands& commands, const PlanePtr& input,
                                  const Params& params, const PlanePtr& neutral_input,
                                  const PlanePtr& tau) {
  commands.dispatch_rows(kernels_.divide_tint,
                         {.frame = input->buffer,
                          .memory = memory_,
                          .tints = tints_,
                          .slots = slots_,
                          .received = received_,
                          .smooth_part = fits_[0],
                          .coefficients = fits_[2],
                          .scene = scene_,
                          .light_state = light_state(),
                          .plain = gpu::by_rows(neutral_input->buffer),
                          .light = gpu::by_rows(tau->buffer)},
                         {.size = extent_,
                          .grid = grid_,
                          .coarse = coarse_,
                          .factor = factor_,
                          .white_level = params.scale.white_level,
                          .residual_sigma = kResidualSigma,
                          .tint_sigma = kTintSigma,
                          .first_row = 0},
                         fours_of(extent_));
  commands.stage("divide-tint");
}

PlanePtr GlobalIntrinsic::record_direct(gpu::Commands& commands, const PlanePtr& neutral_input,
                                        const PlanePtr& tau, const Layers& layers) {
  const PlanePtr light = plan_.light == LightPlanner::Light::measure ? tau : planes_.acquire();
  commands.dispatch_rows(kernels_.direct,
                         {.frame = neutral_input->buffer,
                          .intrinsic = layers[Role::intrinsic]->buffer,
                          .scene = scene_,
                          .tau = gpu::aliased(tau->buffer),
                          .light = gpu::by_rows(light->buffer),
                          .memory = gpu::by_rows(memory_)},
                         {.size = extent_, .first_row = 0}, fours_of(extent_));
  commands.stage("direct");
  return light;
}

Layers GlobalIntrinsic::record_light(gpu::Commands& commands, const PlanePtr& input,
                                     const Params& params, const FrameInfo& info) {
  white_light_.reset();
  const bool keeps = plan_.light != LightPlanner::Light::measure;
  if (plan_.light == LightPlanner::Light::measure_keep) {
    kept_.neutral_input = planes_.acquire();
    kept_.tau = planes_.acquire();
  }
  const PlanePtr neutral_input = keeps ? kept_.neutral_input : planes_.acquire(),
                 tau = keeps ? kept_.tau : planes_.acquire();
  if (!plan_.reused()) record_tint(commands, input, params, neutral_input, tau);
  const uint32_t planes = info.shares ? planes_needed(params) : 0;
  PlanePtr bases = planes > 0 ? kept_.bases : nullptr;
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
                       .near = params.near_share,
                       .own = params.own},
                      line_of(coarse_.pixels() * Model::kSlots));
    if (keeps) kept_.bases = bases;
  }

  Layers layers = solve_.record(commands, neutral_input, params,
                                {.repeated = info.repeated,
                                 .light = colored_light(),
                                 .strokes = info.strokes,
                                 .tracker = info.tracker,
                                 .seen = info.seen,
                                 .known = info.known});
  const PlanePtr light = record_direct(commands, neutral_input, tau, layers);
  layers[Role::input] = input;
  layers[Role::light] = layers[Role::model_light] = light;
  if (bases) {
    layers[Role::bases] = layers[Role::model_bases] = bases;
    share_out(commands, layers, planes);
  }
  commands.keep(input);
  commands.keep(neutral_input);
  commands.keep(tau);
  return layers;
}

GlobalIntrinsic::Findings GlobalIntrinsic::findings(uint64_t frame) const {
  const Report& of = report(frame);
  const float* found = of.found->map_as<float>();
  const auto slot = [&](uint32_t k) { return found + 4 * size_t{k}; };
  const float *amount = slot(Model::SCENE_AMOUNT), *tint = slot(Model::SCENE_TINT);
  Findings findings{.solve = solve_.findings(of.solve),
                    .amount = amount[Model::AMOUNT_KAPPA],
                    .confidence = amount[Model::AMOUNT_CONFIDENCE],
                    .colors = static_cast<uint32_t>(amount[Model::AMOUNT_COLORS]),
                    .tint = tint[Model::TINT_RMS],
                    .cut = slot(Model::SCENE_TIME)[Model::TIME_CUT] > 0,
                    .chroma = tint[Model::TINT_SPREAD]};
  for (uint32_t k = 0; k < Model::kSlots; ++k) {
    const float* color = slot(Model::SCENE_COLORS + k);
    if (!(color[Model::COLOR_USED] > 0)) continue;
    // color_of in model.glsl
    const float u = 0.70710678F * color[0], v = 0.40824829F * color[1];
    const float max = std::max({v + u, v - u, -2 * v});
    findings.bases[k] = {std::exp(v + u - max), std::exp(v - u - max), std::exp(-2 * v - max)};
  }
  return findings;
}

}  // namespace inverse
