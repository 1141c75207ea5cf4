// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scaled_intrinsic.hpp"

#include <algorithm>

namespace inverse {

ScaledIntrinsic::ScaledIntrinsic(std::shared_ptr<gpu::Device> device, Extent extent)
    : device_(std::move(device)), extent_(extent), fade_(device_, extent) {}

void ScaledIntrinsic::set_up(size_t halvings) {
  Extent extent = extent_;
  for (size_t k = 0; k < halvings; ++k, extent = half_of(extent))
    if (!steps_[k]) steps_[k].emplace(device_, extent);
  if (!methods_[halvings]) methods_[halvings].emplace(device_, extent);
}

void ScaledIntrinsic::judge(const Params& params, bool cut) {
  if (since_reset_ < taken_.size()) return;
  const Taken& done = taken(recorded_);  // the last frame that is sure to be done
  // Of another scene nothing is known; at a cut it is looked at as soon as that is noticed.
  if (cut) {
    const uint64_t apart = was_ > 0 ? kAgain : kAgainAtFull;
    compare_at_ = std::max(since_reset_, compared_at_ ? *compared_at_ + apart : 0);
  }
  if (done.stats.compared) half_distance_ = distance_->value(recorded_);
  fits_ = half_distance_ > 0 && half_distance_ < (fits_ ? 1 : kEnter) * params.half_bound;
  if (!done.stats.compared) return;
  // What is far from changing is looked at ever more rarely.
  const bool far = !fits_ && half_distance_ > 1.5F * params.half_bound;
  compare_at_ = since_reset_ + (far ? kMostNext : kNext);
  // Half resolution is set up again when it is next looked at.
  const bool used = std::any_of(taken_.begin(), taken_.end(),
                                [](const Taken& frame) { return frame.stats.halvings == 1; });
  if (far && !used && !stays_[1]) {
    methods_[1].reset();
    if (!methods_[2]) steps_[0].reset();
  }
}

size_t ScaledIntrinsic::choose(const Params& params, const FrameInfo& info) {
  if (info.reset || recorded_ == 0) start_anew();
  bool cut = false;
  if (since_reset_ >= taken_.size()) {
    const Taken& done = taken(recorded_);  // the last frame that is sure to be done
    cut = method(done.stats.halvings).findings(done.number).cut;
  }
  if (cut) fade_.stop();  // what fades is of the scene before
  const size_t asked = params.halvings();
  if (asked > 0 || !params.adaptive || params.half_bound <= 0) {
    fits_ = false;
    return asked;
  }
  judge(params, cut);
  return fits_ ? 1 : 0;
}

PlanePtr ScaledIntrinsic::solve(gpu::Commands& commands, size_t halvings, const PlanePtr& input,
                                const Params& params, const FrameInfo& info) {
  set_up(halvings);
  std::array<PlanePtr, kResolutions> inputs{input};
  for (size_t k = 0; k < halvings; ++k) {
    inputs[k + 1] = steps_[k]->inputs.acquire();
    steps_[k]->halve.record(commands, *inputs[k], *inputs[k + 1]);
    commands.keep(inputs[k + 1]);
  }
  if (halvings > 0) commands.stage("halve");
  // Tiles are those of the full resolution.
  const FrameInfo here = halvings > 0 ? FrameInfo{info.reset, {}} : info;
  PlanePtr intrinsic =
      method(halvings).record(commands, inputs[halvings], params, here)[Role::intrinsic];
  for (size_t k = halvings; k-- > 0;) {
    const PlanePtr finer = steps_[k]->layers.acquire();
    steps_[k]->upsample.record(commands, inputs[k]->buffer, intrinsic->buffer, finer->buffer);
    commands.keep(finer);
    intrinsic = finer;
  }
  if (halvings > 0) commands.stage("upsample");
  return intrinsic;
}

void ScaledIntrinsic::take_over(gpu::Commands& commands, size_t from, size_t to,
                                PlanePtr intrinsic) {
  set_up(to);
  for (size_t k = 0; k < to; ++k) {
    const PlanePtr smaller = steps_[k]->inputs.acquire();
    steps_[k]->halve.record(commands, *intrinsic, *smaller);
    commands.keep(smaller);
    intrinsic = smaller;
  }
  method(to).take_over(commands, method(from), std::move(intrinsic));
}

Layers ScaledIntrinsic::record(gpu::Commands& commands, const PlanePtr& input, const Params& params,
                               const FrameInfo& info) {
  const size_t now = choose(params, info);
  const bool crossed = recorded_ > 0 && now != was_ && !info.reset;
  PlanePtr shown;
  if (crossed) {
    const PlanePtr old = solve(commands, was_, input, params, info);
    shown = fade_.record(commands, input, old);
    take_over(commands, was_, now, old);
  }
  const PlanePtr intrinsic = solve(commands, now, input, params, info);
  if (crossed)
    fade_.start(commands, input, shown, intrinsic);
  else
    shown = fade_.record(commands, input, intrinsic);
  Taken& taken = taken_[recorded_];
  taken = {{method(now).stats(method(now).recorded() - 1), now, crossed, false},
           method(now).recorded() - 1,
           half_distance_};
  const bool decides = params.halvings() == 0 && params.adaptive && params.half_bound > 0;
  if (decides && !crossed && since_reset_ >= compare_at_) {
    // From nothing, as what it would come to by itself is asked for.
    const PlanePtr other = solve(commands, 1 - now, input, params, {true, {}});
    if (!distance_) distance_.emplace(device_, extent_);
    distance_->record(commands, input->buffer, intrinsic->buffer, other->buffer, recorded_);
    commands.stage("compare");
    taken.stats.compared = true;
    compared_at_ = since_reset_;
    compare_at_ = since_reset_ + kMostNext;  // until its outcome is known
  }
  plain_ = now == 0 && !crossed && shown == intrinsic ? std::min(plain_ + 1, 2U) : 0;
  was_ = now;
  ++recorded_;
  ++since_reset_;
  commands.keep(input);
  commands.keep(shown);
  return intrinsic_layers(input, shown);
}

void ScaledIntrinsic::reset() {
  for (auto& method : methods_)
    if (method) method->reset();
  start_anew();
}

void ScaledIntrinsic::start_anew() {
  since_reset_ = 0;
  compare_at_ = kFirst;
  compared_at_.reset();
  fits_ = false;
  half_distance_ = 0;
  fade_.stop();
}

ScaledIntrinsic::Findings ScaledIntrinsic::findings(uint64_t frame) const {
  const Taken& of = taken(frame);
  return {methods_[of.stats.halvings]->findings(of.number), of.half_distance};
}

}  // namespace inverse
