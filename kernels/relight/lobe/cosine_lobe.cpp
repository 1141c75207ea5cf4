#include "cosine_lobe.hpp"

#include <cstring>

#include "kernels/gpu/shaders.hpp"

INVERSE_SHADER(relight_lobe_directions);
INVERSE_SHADER(relight_lobe_light_table);
INVERSE_SHADER(relight_lobe_lobes);
INVERSE_SHADER(relight_lobe_relight);
INVERSE_SHADER(relight_lobe_relight_sum);
INVERSE_SHADER(relight_lobe_respond);

namespace inverse {
namespace {

constexpr uint32_t kSide = 65, kLevels = 13;  // lobe.glsl
constexpr uint64_t kEntries = uint64_t{kSide} * kSide * kLevels;

gpu::BufferPtr uploaded(const std::shared_ptr<gpu::Device>& device,
                        std::span<const WeightedLight> lights) {
  auto buffer = gpu::Buffer::create(device, gpu::Element::vec4,
                                    std::max<size_t>(2 * lights.size(), 1), gpu::Memory::upload);
  auto* to = buffer->map_as<float>();
  for (const WeightedLight& light : lights) {
    for (size_t k = 0; k < 3; ++k) {
      to[k] = static_cast<float>(light.direction[k]);
      to[4 + k] = light.weight[k];
    }
    to[3] = to[7] = 0;
    to += 8;
  }
  return buffer;
}

PlanePtr plane(const std::shared_ptr<gpu::Device>& device, Extent extent) {
  return PlanePool(device, extent).acquire();
}

Rgb even_light(std::span<const WeightedLight> lights, uint32_t stage_lights) {
  Rgb sum{};
  for (const WeightedLight& light : lights)
    for (size_t c = 0; c < 3; ++c) sum[c] += light.weight[c] / static_cast<float>(stage_lights);
  return sum;
}

}  // namespace

CosineLobe::CosineLobe(const std::shared_ptr<gpu::Device>& device, Extent extent,
                       std::shared_ptr<const LobeMoments> moments,
                       std::span<const Direction> lights)
    : device_(device),
      extent_(extent),
      moments_(std::move(moments)),
      stage_lights_(static_cast<uint32_t>(lights.size())),
      find_(device->kernel(shaders::relight_lobe_lobes)),
      table_kernel_(device->kernel(shaders::relight_lobe_light_table)),
      relight_(device->kernel(shaders::relight_lobe_relight)),
      sum_(device->kernel(shaders::relight_lobe_relight_sum)),
      respond_(device->kernel(shaders::relight_lobe_respond)),
      directions_(device->kernel(shaders::relight_lobe_directions)),
      grid_(gpu::Buffer::create(device, gpu::Element::vec4, moments_->table().size(),
                                gpu::Memory::upload)),
      gains_(gpu::Buffer::create(device, gpu::Element::vec4, kEntries)),
      table_(gpu::Buffer::create(device, gpu::Element::vec4, kEntries)),
      full_(plane(device, extent)),
      lobes_(plane(device, extent)) {
  memcpy(grid_->map(), moments_->table().data(), grid_->bytes());
  std::vector<WeightedLight> all;
  for (const Direction& w : lights) all.push_back({w, {1, 1, 1}});
  stage_ = uploaded(device, all);
}

void CosineLobe::make_gains(gpu::Commands& commands) {
  const struct {
    int lights;
    uint32_t gains;
  } push{static_cast<int>(stage_lights_), 1};
  commands.dispatch(table_kernel_, {stage_, stage_, gains_}, push, {kSide * kSide});
  has_gains_ = true;
}

void CosineLobe::record_lobes(gpu::Commands& commands, const GradientPair& pair,
                              const Params& params) {
  if (!has_gains_) make_gains(commands);
  const float noise = params.noise >= 1e-6F ? params.noise : 1e-6F;
  const struct {
    uint32_t width, height, stride, second;
    int grid;
    float noise2, exponent;
  } push{extent_.width,
         extent_.height,
         pair.a.extent.width,
         pair.second,
         static_cast<int>(LobeMoments::kGrid),
         noise * noise,
         static_cast<float>(moments_->largest_exponent())};
  commands.dispatch(find_, {pair.a.buffer, pair.b.buffer, grid_, full_->buffer, lobes_->buffer},
                    push, {extent_.width, extent_.height});
}

void CosineLobe::record_lights(gpu::Commands& commands, std::span<const WeightedLight> lights) {
  if (!has_gains_) make_gains(commands);
  const struct {
    int lights;
    uint32_t gains;
  } push{static_cast<int>(lights.size()), 0};
  commands.dispatch(table_kernel_, {uploaded(device_, lights), gains_, table_}, push,
                    {kSide * kSide});
  even_ = even_light(lights, stage_lights_);
}

void CosineLobe::record_relit(gpu::Commands& commands, const Plane& target) const {
  const struct {
    float even[4];
    uint32_t width, height;
  } push{{even_[0], even_[1], even_[2], 0}, extent_.width, extent_.height};
  commands.dispatch(relight_, {full_->buffer, lobes_->buffer, table_, target.buffer}, push,
                    {extent_.width, extent_.height});
}

void CosineLobe::record_sum(gpu::Commands& commands, std::span<const WeightedLight> lights,
                            const Plane& target) const {
  const Rgb even = even_light(lights, stage_lights_);
  const struct {
    float even[4];
    uint32_t width, height;
    int lights;
  } push{{even[0], even[1], even[2], 0},
         extent_.width,
         extent_.height,
         static_cast<int>(lights.size())};
  commands.dispatch(
      sum_, {full_->buffer, lobes_->buffer, gains_, uploaded(device_, lights), target.buffer}, push,
      {extent_.width, extent_.height});
}

void CosineLobe::record_directions(gpu::Commands& commands, const Params& params,
                                   const Plane& target) const {
  const struct {
    uint32_t width, height;
    float least;
  } push{extent_.width, extent_.height, params.noise};
  commands.dispatch(directions_, {full_->buffer, lobes_->buffer, target.buffer}, push,
                    {extent_.width, extent_.height});
}

void CosineLobe::record_responses(gpu::Commands& commands, const gpu::BufferPtr& samples,
                                  const gpu::BufferPtr& responses) const {
  const struct {
    uint32_t samples, lights;
  } push{static_cast<uint32_t>(samples->count()), stage_lights_};
  commands.dispatch(respond_, {full_->buffer, lobes_->buffer, gains_, stage_, samples, responses},
                    push, {push.samples * push.lights});
}

}  // namespace inverse
