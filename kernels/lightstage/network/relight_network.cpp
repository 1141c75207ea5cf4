// SPDX-License-Identifier: LGPL-2.1-or-later
#include "relight_network.hpp"

#include <algorithm>

namespace inverse {
namespace {

using Models = RelightModels;
using Head = shaders::lightstage_network_head_sum;
constexpr uint32_t kLightSize = Head::kLightSize, kAtOnce = Head::kAtOnce,
                   kHiddenBlocks = Head::kHiddenBlocks;
static_assert(Models::kPlanes == Head::kBlocks && Models::kHidden == 4 * Head::kHiddenBlocks);

Extent padded(Extent extent) {
  const auto up = [](uint32_t v) {
    return (v + Models::kStep - 1) / Models::kStep * Models::kStep;
  };
  return {up(extent.width), up(extent.height)};
}

network::Shape input_shape(Extent extent) { return {6, extent.height, extent.width}; }

Models without_features(const Models& models) {
  Models head = models;
  head.features = {};
  return head;
}

/// The head's weights in the order of light_head.glsl.
gpu::BufferPtr uploaded_weights(const std::shared_ptr<gpu::Device>& device, const Models& m) {
  std::vector<float> weights(4 * (kHiddenBlocks * 20 + 1));
  auto to = weights.begin();
  for (size_t block = 0; block < kHiddenBlocks; ++block) {
    for (size_t k = 0; k < Models::kPlanes; ++k)
      for (size_t j = 4 * block; j < 4 * block + 4; ++j)
        *to++ = m.inner[j * (Models::kPlanes + Models::kHarmonics) + k];
    for (size_t j = 4 * block; j < 4 * block + 4; ++j)
      for (size_t o = 0; o < Models::kOut; ++o) *to++ = m.outer[o * Models::kHidden + j];
  }
  std::copy(m.outer_bias.begin(), m.outer_bias.end(), to);
  return gpu::make_table(device, gpu::Element::vec4, weights);
}

}  // namespace

RelightNetwork::RelightNetwork(const std::shared_ptr<gpu::Device>& device, Extent extent,
                               const RelightModels& models)
    : device_(device),
      extent_(extent),
      padded_(inverse::padded(extent)),
      head_(without_features(models)),
      network_(device, models.features, std::array{input_shape(padded_)}),
      encode_(device),
      sum_(device),
      respond_(device),
      weights_(uploaded_weights(device, models)),
      difference_(gpu::Buffer::create(device, gpu::Element::vec4, extent.pixels())) {}

void RelightNetwork::record_features(gpu::Commands& commands, const GradientPair& pair) {
  commands.dispatch(
      encode_,
      {.a = pair.a.buffer,
       .b = pair.b.buffer,
       .image = network_.input(0),
       .difference = difference_},
      {.size = extent_, .padded = padded_, .stride = pair.a.extent.width, .second = pair.second},
      {padded_.width, padded_.height});
  network_.record(commands);
}

uint32_t RelightNetwork::write_lights(gpu::Commands& commands,
                                      std::span<const WeightedLight> lights, double share) {
  const size_t count = (std::max<size_t>(lights.size(), 1) + kAtOnce - 1) / kAtOnce * kAtOnce;
  std::vector<float> rows(4 * kLightSize * count);
  float* to = rows.data();
  for (const WeightedLight& light : lights) {
    for (size_t k = 0; k < 3; ++k) {
      to[k] = static_cast<float>(light.direction[k]);
      to[4 + k] = static_cast<float>(light.weight[k] * share);
    }
    to[3] = 1;
    const auto bias = head_.bias_for(light.direction);
    std::copy(bias.begin(), bias.end(), to + 8);
    to += 4 * kLightSize;
  }
  commands.write_table(lights_, gpu::Element::vec4, rows);
  return static_cast<uint32_t>(count);
}

void RelightNetwork::record_sum(gpu::Commands& commands, const Plane& full,
                                std::span<const WeightedLight> lights, double share,
                                const Plane& target, const MeasuredLight& measured, float noise) {
  const uint32_t count = write_lights(commands, lights, share);
  const auto four = [](const Rgb& v, float w) { return std::array{v[0], v[1], v[2], w}; };
  commands.dispatch(sum_,
                    {.full = full.buffer,
                     .features = features(),
                     .head_weights = weights_,
                     .lights = lights_,
                     .difference = difference_,
                     .picture = target.buffer},
                    {.even = four(measured.even, std::max(noise * noise, 1e-12F)),
                     .along = {four(measured.along[0], 0), four(measured.along[1], 0),
                               four(measured.along[2], 0)},
                     .size = extent_,
                     .padded = padded_,
                     .lights = static_cast<int32_t>(count)},
                    {extent_.width, extent_.height});
}

void RelightNetwork::record_responses(gpu::Commands& commands, const Plane& full,
                                      std::span<const Direction> lights, double share,
                                      const gpu::BufferPtr& samples,
                                      const gpu::BufferPtr& responses) {
  std::vector<WeightedLight> all;
  for (const Direction& w : lights) all.push_back({w, {1, 1, 1}});
  const uint32_t fours = write_lights(commands, all, share) / kAtOnce;
  const auto count = static_cast<uint32_t>(samples->count());
  commands.dispatch(respond_,
                    {.full = full.buffer,
                     .features = features(),
                     .head_weights = weights_,
                     .lights = lights_,
                     .samples = samples,
                     .response = responses},
                    {.size = extent_,
                     .padded = padded_,
                     .lights = static_cast<uint32_t>(lights.size()),
                     .fours = fours,
                     .samples = count},
                    {count * fours});
}

}  // namespace inverse
