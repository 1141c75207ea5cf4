// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scaled_intrinsic.hpp"

#include <algorithm>
#include <utility>

namespace inverse {

ScaledIntrinsic::ScaledIntrinsic(std::shared_ptr<gpu::Device> device, Extent extent)
    : device_(std::move(device)),
      extent_(extent),
      fade_(device_, extent),
      min_halvings_(min_halvings(*device_, extent)) {
  IntrinsicDecomposition(device_, kTiny);
  Step(device_, kTiny);
  LayerDistance(device_, kTiny);
  SceneLight(device_, kTiny);
}

size_t ScaledIntrinsic::min_halvings(const gpu::Device& device, Extent extent) {
  const gpu::Limits& limits = device.limits();
  const uint64_t max_pixels = limits.storage_buffer_bytes / gpu::element_bytes(gpu::Element::vec4);
  size_t halvings = 0;
  for (Extent solved = extent; solved.pixels() > max_pixels; solved = half_of(solved))
    if (++halvings == kResolutions)
      throw Error(ErrorKind::limit, "frames of " + std::to_string(extent.width) + "x" +
                                        std::to_string(extent.height) + " are too large for \"" +
                                        device.name() + "\", which takes up to " +
                                        std::to_string(max_pixels * 16 / 1'000'000) +
                                        " million pixels; use a smaller frame or another device");
  return halvings;
}

void ScaledIntrinsic::set_up(size_t halvings) {
  Extent extent = extent_;
  for (size_t k = 0; k < halvings; ++k, extent = half_of(extent))
    if (!steps_[k]) steps_[k].emplace(device_, extent);
  if (!methods_[halvings]) methods_[halvings].emplace(device_, extent);
}

std::optional<ResolutionPlanner::Found> ScaledIntrinsic::found_before() const {
  if (recorded_ < gpu::kFramesInFlight) return {};
  const Past& done = past(recorded_);  // the last frame that is sure to be done
  const auto& method = methods_[done.stats.halvings];
  return ResolutionPlanner::Found{
      .cut = method && method->findings(done.number).cut,
      .compared = done.stats.compared,
      .distance = done.stats.compared ? distance_->value(recorded_) : 0};
}

void ScaledIntrinsic::release_half() {
  const bool used = std::any_of(past_.begin(), past_.end(),
                                [](const Past& frame) { return frame.stats.halvings == 1; });
  if (used || stays_[1]) return;
  methods_[1].reset();
  if (!methods_[2]) steps_[0].reset();
}

ScaledIntrinsic::Solved ScaledIntrinsic::solve(gpu::Commands& commands, size_t halvings,
                                               const PlanePtr& input, const Params& params,
                                               const FrameInfo& info) {
  set_up(halvings);
  std::array<PlanePtr, kResolutions> inputs{input};
  for (size_t k = 0; k < halvings; ++k) {
    inputs[k + 1] = steps_[k]->inputs.acquire();
    steps_[k]->halve.record(commands, *inputs[k], *inputs[k + 1]);
    commands.keep(inputs[k + 1]);
  }
  if (halvings > 0) commands.stage("halve");
  const Layers layers = method(halvings).record(commands, inputs[halvings], params, info);
  Solved solved{layers[Role::intrinsic], layers[Role::slope]};
  for (size_t k = halvings; k-- > 0;) {
    const PlanePtr finer = steps_[k]->layers.acquire();
    steps_[k]->upsample.record(commands, inputs[k]->buffer, solved.intrinsic->buffer, solved.slope,
                               finer->buffer);
    commands.keep(finer);
    solved.intrinsic = finer;
  }
  if (halvings > 0) commands.stage("upsample");
  return solved;
}

void ScaledIntrinsic::warm_start(gpu::Commands& commands, size_t from, size_t to,
                                 PlanePtr intrinsic) {
  set_up(to);
  for (size_t k = 0; k < to; ++k) {
    const PlanePtr smaller = steps_[k]->inputs.acquire();
    steps_[k]->halve.record(commands, *intrinsic, *smaller);
    commands.keep(smaller);
    intrinsic = smaller;
  }
  method(to).continue_from(commands, method(from), std::move(intrinsic));
}

Layers ScaledIntrinsic::record(gpu::Commands& commands, const PlanePtr& input, const Params& params,
                               const FrameInfo& frame) {
  if (frame.reset) restart();
  FrameInfo info = frame;
  const auto found = found_before();
  if (!params.light.colored()) {
    if (light_) light_->restart();
  } else if (!info.light) {
    if (!light_) light_.emplace(device_, extent_);
    light_->record(commands, input->buffer, params.light, first_);
    commands.stage("light-color");
    info.light = &*light_;
  }
  first_ = false;
  if (std::exchange(strokes_, info.strokes) != info.strokes) fade_.stop();
  const auto choice = planner_.next(
      {params.adaptive, std::max(params.halvings(), min_halvings_), params.tolerances.half}, found);
  if (choice.cut) fade_.stop();
  if (choice.half_rejected) release_half();
  const size_t now = choice.halvings;
  const bool crossed = choice.crosses && !info.reset;
  PlanePtr shown;
  if (crossed) {
    const Solved old = solve(commands, was_, input, params, info);
    shown = fade_.record(commands, input, old.intrinsic, old.slope);
    warm_start(commands, was_, now, old.intrinsic);
  }
  const auto [intrinsic, slope] = solve(commands, now, input, params, info);
  if (crossed)
    fade_.start(commands, input, shown, intrinsic);
  else
    shown = fade_.record(commands, input, intrinsic, slope);
  Past& past = past_[recorded_];
  past = {{method(now).stats(method(now).recorded() - 1), params.light, now, crossed, false},
          method(now).recorded() - 1,
          planner_.half_distance()};
  if (choice.full_because)
    past.stats.plan.run.push_back(std::string("full resolution: ") + choice.full_because);
  if (choice.compares) {
    // Without history: the result that it would have by itself.
    const PlanePtr other = solve(commands, 1 - now, input, params,
                                 {.reset = true,
                                  .light = info.light,
                                  .strokes = info.strokes,
                                  .tracker = info.tracker,
                                  .seen = info.seen})
                               .intrinsic;
    if (!distance_) distance_.emplace(device_, extent_);
    distance_->record(commands, input->buffer, intrinsic->buffer, other->buffer, recorded_);
    commands.stage("compare");
    past.stats.compared = true;
    past.stats.plan.run.emplace_back("other resolution: it is compared in this frame");
  }
  was_ = now;
  ++recorded_;
  commands.keep(input);
  commands.keep(shown);
  return intrinsic_layers(input, shown, slope);
}

void ScaledIntrinsic::reset() {
  for (auto& method : methods_)
    if (method) method->reset();
  restart();
}

void ScaledIntrinsic::restart() {
  planner_.reset();
  fade_.stop();
  first_ = true;
}

ScaledIntrinsic::Findings ScaledIntrinsic::findings(uint64_t frame) const {
  const Past& of = past(frame);
  return {methods_[of.stats.halvings]->findings(of.number), of.half_distance};
}

}  // namespace inverse
