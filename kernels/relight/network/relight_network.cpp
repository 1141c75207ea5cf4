#include "relight_network.hpp"

#include <algorithm>

#include "kernels/gpu/shaders.hpp"

INVERSE_SHADER(relight_network_encode);
INVERSE_SHADER(relight_network_head_respond);
INVERSE_SHADER(relight_network_head_sum);

namespace inverse {
namespace {

using Models = RelightModels;
constexpr uint32_t kLightSize = 8, kAtOnce = 4;  // light_head.glsl
constexpr uint32_t kHiddenBlocks = Models::kHidden / 4;

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
  auto buffer =
      gpu::Buffer::create(device, gpu::Element::vec4, kHiddenBlocks * 20 + 1, gpu::Memory::upload);
  auto* to = buffer->map_as<float>();
  for (size_t block = 0; block < kHiddenBlocks; ++block) {
    for (size_t k = 0; k < Models::kPlanes; ++k)
      for (size_t j = 4 * block; j < 4 * block + 4; ++j)
        *to++ = m.inner[j * (Models::kPlanes + Models::kHarmonics) + k];
    for (size_t j = 4 * block; j < 4 * block + 4; ++j)
      for (size_t o = 0; o < Models::kOut; ++o) *to++ = m.outer[o * Models::kHidden + j];
  }
  std::copy(m.outer_bias.begin(), m.outer_bias.end(), to);
  return buffer;
}

}  // namespace

RelightNetwork::RelightNetwork(const std::shared_ptr<gpu::Device>& device, Extent extent,
                               const RelightModels& models)
    : device_(device),
      extent_(extent),
      padded_(inverse::padded(extent)),
      head_(without_features(models)),
      network_(device, models.features, std::array{input_shape(padded_)}),
      encode_(device->kernel(shaders::relight_network_encode)),
      sum_(device->kernel(shaders::relight_network_head_sum)),
      respond_(device->kernel(shaders::relight_network_head_respond)),
      weights_(uploaded_weights(device, models)),
      difference_(gpu::Buffer::create(device, gpu::Element::vec4, extent.pixels())) {}

void RelightNetwork::record_features(gpu::Commands& commands, const GradientPair& pair) {
  const struct {
    uint32_t width, height, padded_width, padded_height, stride, second;
  } push{extent_.width,  extent_.height,      padded_.width,
         padded_.height, pair.a.extent.width, pair.second};
  commands.dispatch(encode_, {pair.a.buffer, pair.b.buffer, network_.input(0), difference_}, push,
                    {padded_.width, padded_.height});
  network_.record(commands);
}

gpu::BufferPtr RelightNetwork::uploaded(std::span<const WeightedLight> lights, double share) const {
  const size_t count = (std::max<size_t>(lights.size(), 1) + kAtOnce - 1) / kAtOnce * kAtOnce;
  auto buffer =
      gpu::Buffer::create(device_, gpu::Element::vec4, kLightSize * count, gpu::Memory::upload);
  auto* to = buffer->map_as<float>();
  std::fill(to, to + 4 * kLightSize * count, 0.0F);
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
  return buffer;
}

void RelightNetwork::record_sum(gpu::Commands& commands, const Plane& full,
                                std::span<const WeightedLight> lights, double share,
                                const Plane& target, const MeasuredLight& measured,
                                float noise) const {
  const gpu::BufferPtr list = uploaded(lights, share);
  const auto four = [](const Rgb& v, float w) { return std::array{v[0], v[1], v[2], w}; };
  const struct {
    std::array<float, 4> even;
    std::array<std::array<float, 4>, 3> along;
    uint32_t width, height, padded_width, padded_height;
    int lights;
  } push{four(measured.even, std::max(noise * noise, 1e-12F)),
         {four(measured.along[0], 0), four(measured.along[1], 0), four(measured.along[2], 0)},
         extent_.width,
         extent_.height,
         padded_.width,
         padded_.height,
         static_cast<int>(list->count() / kLightSize)};
  commands.dispatch(sum_, {full.buffer, features(), weights_, list, difference_, target.buffer},
                    push, {extent_.width, extent_.height});
}

void RelightNetwork::record_responses(gpu::Commands& commands, const Plane& full,
                                      std::span<const Direction> lights, double share,
                                      const gpu::BufferPtr& samples,
                                      const gpu::BufferPtr& responses) const {
  std::vector<WeightedLight> all;
  for (const Direction& w : lights) all.push_back({w, {1, 1, 1}});
  const gpu::BufferPtr list = uploaded(all, share);
  const auto count = static_cast<uint32_t>(lights.size());
  const struct {
    uint32_t width, height, padded_width, padded_height, lights, fours, samples;
  } push{extent_.width,
         extent_.height,
         padded_.width,
         padded_.height,
         count,
         static_cast<uint32_t>(list->count() / kLightSize / kAtOnce),
         static_cast<uint32_t>(samples->count())};
  commands.dispatch(respond_, {full.buffer, features(), weights_, list, samples, responses}, push,
                    {push.samples * push.fours});
}

}  // namespace inverse
