#include "scaled_intrinsic.hpp"

namespace inverse {

void ScaledIntrinsic::prepare(bool half_resolution) {
  if (half_resolution && !half_) half_.emplace(device_, extent_);
  if (!half_resolution && !full_) full_.emplace(device_, extent_);
}

Layers ScaledIntrinsic::record(gpu::Commands& commands, const PlanePtr& input, const Params& params,
                               const FrameInfo& info) {
  const bool half = params.half_resolution, changed = recorded_ > 0 && half != was_half_;
  prepare(half);
  IntrinsicDecomposition& now = half ? half_->method : *full_;
  if (changed && !info.reset) now.take_gauge(commands, half ? *full_ : half_->method);
  taken_[recorded_++ % taken_.size()] = {half, now.recorded()};
  was_half_ = half;
  return half ? record_half(commands, input, params, info)
              : full_->record(commands, input, params, info);
}

Layers ScaledIntrinsic::record_half(gpu::Commands& commands, const PlanePtr& input,
                                    const Params& params, const FrameInfo& info) {
  const PlanePtr small = half_->inputs.acquire(), intrinsic = half_->layers.acquire();
  half_->halve.record(commands, *input, *small);
  commands.stage("halve");
  const Layers found = half_->method.record(commands, small, params, {info.reset, {}});
  half_->upsample.record(commands, input->buffer, found[Role::intrinsic]->buffer,
                         intrinsic->buffer);
  commands.stage("upsample");
  commands.keep(input);
  commands.keep(intrinsic);
  return intrinsic_layers(input, intrinsic);
}

void ScaledIntrinsic::reset() {
  if (full_) full_->reset();
  if (half_) half_->method.reset();
}

ScaledIntrinsic::Stats ScaledIntrinsic::stats(uint64_t frame) const {
  const Taken& taken = taken_[frame % taken_.size()];
  return {method(taken.half).stats(taken.number), taken.half};
}

ScaledIntrinsic::Findings ScaledIntrinsic::findings(uint64_t frame) const {
  const Taken& taken = taken_[frame % taken_.size()];
  return method(taken.half).findings(taken.number);
}

}  // namespace inverse
