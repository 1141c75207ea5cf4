// SPDX-License-Identifier: LGPL-2.1-or-later
#include "relighting.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/error.hpp"

namespace inverse {
namespace {

/// Random pixels of a frame, one in each cell of a grid (stratified).
std::vector<uint32_t> spread_pixels(Extent extent, uint32_t count) {
  std::vector<uint32_t> pixels;
  if (extent.pixels() <= count) {
    for (uint32_t i = 0; i < extent.pixels(); ++i) pixels.push_back(i);
    return pixels;
  }
  const double aspect = static_cast<double>(extent.width) / extent.height;
  const auto columns = std::clamp<uint32_t>(static_cast<uint32_t>(std::sqrt(count * aspect)), 1,
                                            std::min(count, extent.width));
  const uint32_t rows = std::clamp<uint32_t>(count / columns, 1, extent.height);
  uint32_t random = 1;
  const auto place = [&random](uint32_t part, uint32_t parts, uint32_t size) {
    random = random * 1664525U + 1013904223U;
    const double at = (part + (random >> 8) / double{1 << 24}) / parts * size;
    return std::min(static_cast<uint32_t>(at), size - 1);
  };
  for (uint32_t row = 0; row < rows; ++row)
    for (uint32_t column = 0; column < columns; ++column) {
      const uint32_t y = place(row, rows, extent.height);
      pixels.push_back(y * extent.width + place(column, columns, extent.width));
    }
  return pixels;
}

void brighten(Rgb& light, float gain) {
  for (float& channel : light) channel *= gain;
}

}  // namespace

Relighting::Relighting(const std::shared_ptr<gpu::Device>& device, Extent extent,
                       std::shared_ptr<const RelightStage> stage, const RelightModels* models)
    : device_(device),
      stage_(std::move(stage)),
      lobe_(device, extent, stage_->moments, stage_->lights()),
      network_(models ? std::make_unique<RelightNetwork>(device, extent, *models) : nullptr),
      reduction_(stage_->lights()) {
  if (!network_) return;
  samples_ = gpu::make_table(device, gpu::Element::word, spread_pixels(extent, kSamples));
  responses_ =
      gpu::Buffer::create(device, gpu::Element::vec4, samples_->count() * stage_->lights().size(),
                          gpu::Memory::readback);
}

RelightNetwork& Relighting::network() const {
  if (!network_) throw Error(ErrorKind::internal, "no network was loaded to relight with");
  return *network_;
}

void Relighting::set_environment(LightCells::Map map) {
  map_ = std::move(map);
  weighed_.reset();
  ++version_;
}

void Relighting::forget() {
  fitted_.reset();
  has_features_ = false;
  asked_.reset();
  measured_at_.reset();
  retry_ = 0;
  reduction_.clear();
  chosen_.reset();
  ++version_;
}

void Relighting::record_pair(gpu::Commands& commands, const GradientPair& pair,
                             const Params& params, uint64_t number, bool again, bool lit) {
  take_responses(params, number);
  stats_ = {};
  stats_.lights = stage_->lights().size();
  if (!again || !fitted_ || !(*fitted_ == params.lobe)) {
    lobe_.record_lobes(commands, pair, params.lobe);
    commands.stage("lobes");
    fitted_ = params.lobe;
    stats_.fitted = true;
    ++version_;
  }
  if (!again) has_features_ = false;
  if (params.model != Model::network || !lit || has_features_) return;
  network().record_features(commands, pair);
  commands.stage("features");
  has_features_ = true;
  const bool due = !asked_ && (!measured_at_ || number >= *measured_at_ + kEvery);
  if (!params.adaptive || params.max_error <= 0 || !due) return;
  network().record_responses(commands, *lobe_.full(), stage_->lights(), stage_->share, samples_,
                             responses_);
  commands.stage("samples");
  asked_ = measured_at_ = number;
}

void Relighting::take_responses(const Params& params, uint64_t number) {
  // A frame this far back is finished on every device, so that the choice does not depend on the
  // device's speed.
  if (!asked_ || number < *asked_ + gpu::kFramesInFlight) return;
  asked_.reset();
  reduction_.set_responses({responses_->map_as<float>(), 4 * responses_->count()});
  if (!choice_ || !chosen_) return;
  if (choice_->all) {
    if (number < retry_) return;
    retry_ = number + kRetry;
    chosen_.reset();
    return;
  }
  // A choice that is still accurate enough, but not far better than required, is kept: no flicker.
  const double error = reduction_.error(*choice_, split_.rest, weights_);
  choice_->error = error;
  if (error > params.max_error || error < 0.3 * params.max_error) chosen_.reset();
}

void Relighting::choose(const Params& params) {
  if (!weighed_ || weighed_->rotation != params.rotation) {
    weights_ = stage_->cells.weights(map_, double{params.rotation} * std::numbers::pi / 180);
    split_ = SplitLight::of(stage_->lights(), weights_);
    weighed_ = params;
    chosen_.reset();
  }
  const bool network = params.model == Model::network, few = params.adaptive && network;
  if (chosen_ && chosen_->model == params.model && chosen_->adaptive == params.adaptive &&
      chosen_->max_error == params.max_error)
    return;
  choice_ = reduction_.choose(network ? split_.rest : weights_, weights_,
                              few ? double{params.max_error} : 0);
  chosen_ = params;
  table_is_old_ = true;
  ++version_;
}

void Relighting::record_relit(gpu::Commands& commands, const Params& params, const Plane& target) {
  choose(params);
  auto lights = choice_->lights;
  MeasuredLight measured = split_.measured;
  const float gain = std::exp2(params.exposure);
  for (WeightedLight& light : lights) brighten(light.weight, gain);
  brighten(measured.even, gain);
  for (Rgb& along : measured.along) brighten(along, gain);
  stats_.evaluated = lights.size();
  stats_.expected_error = choice_->error;
  stats_.lit = static_cast<uint64_t>(std::count_if(
      weights_.begin(), weights_.end(), [](const Rgb& w) { return w[0] + w[1] + w[2] > 0; }));
  stats_.shown = LightCells::shown(map_, weights_, stage_->cells.covered());
  if (params.model == Model::network) {
    network().record_sum(commands, *lobe_.full(), lights, stage_->share, target, measured,
                         params.lobe.noise);
  } else if (!params.adaptive) {
    lobe_.record_sum(commands, lights, target);
  } else {
    if (table_is_old_ || table_exposure_ != params.exposure) lobe_.record_lights(commands, lights);
    table_is_old_ = false;
    table_exposure_ = params.exposure;
    lobe_.record_relit(commands, target);
  }
  commands.stage("relight");
}

void Relighting::record_olat(gpu::Commands& commands, const Params& params, const Direction& light,
                             const Plane& target) {
  const float weight =
      0.25F * static_cast<float>(stage_->lights().size()) * std::exp2(params.exposure);
  const WeightedLight one{light, {weight, weight, weight}};
  if (stats_.evaluated == 0) stats_.evaluated = 1;
  if (params.model == Model::network)
    network().record_sum(commands, *lobe_.full(), std::span(&one, 1), stage_->share, target);
  else
    lobe_.record_sum(commands, std::span(&one, 1), target);
  commands.stage("one-light");
}

}  // namespace inverse
