// SPDX-License-Identifier: LGPL-2.1-or-later
#include "cosine_lobe.hpp"

#include <cstring>

namespace inverse {
namespace {

constexpr uint32_t kSide = shaders::lightstage_lobe_lobes::kSide,
                   kLevels = shaders::lightstage_lobe_lobes::kLevels;
constexpr uint64_t kEntries = uint64_t{kSide} * kSide * kLevels;

std::vector<float> rows_of(std::span<const WeightedLight> lights) {
  std::vector<float> rows(8 * lights.size());
  for (size_t i = 0; i < lights.size(); ++i)
    for (size_t k = 0; k < 3; ++k) {
      rows[8 * i + k] = static_cast<float>(lights[i].direction[k]);
      rows[8 * i + 4 + k] = lights[i].weight[k];
    }
  return rows;
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
      find_(device),
      table_kernel_(device),
      relight_(device),
      sum_(device),
      respond_(device),
      directions_(device),
      grid_(gpu::make_table(device, gpu::Element::vec4, moments_->table())),
      gains_(gpu::Buffer::create(device, gpu::Element::vec4, kEntries)),
      table_(gpu::Buffer::create(device, gpu::Element::vec4, kEntries)),
      full_(plane(device, extent)),
      lobes_(plane(device, extent)) {
  std::vector<WeightedLight> all;
  for (const Direction& w : lights) all.push_back({w, {1, 1, 1}});
  stage_ = gpu::make_table(device, gpu::Element::vec4, rows_of(all));
}

void CosineLobe::make_gains(gpu::Commands& commands) {
  commands.dispatch(table_kernel_, {.lights = stage_, .gain = stage_, .table = gains_},
                    {.lights = static_cast<int32_t>(stage_lights_), .gains = 1}, {kSide * kSide});
  has_gains_ = true;
}

void CosineLobe::record_lobes(gpu::Commands& commands, const GradientPair& pair,
                              const Params& params) {
  if (!has_gains_) make_gains(commands);
  const float noise = params.noise >= 1e-6F ? params.noise : 1e-6F;
  commands.dispatch_rows(find_,
                         {.a = pair.a.buffer,
                          .b = pair.b.buffer,
                          .moments = grid_,
                          .full = gpu::by_rows(full_->buffer),
                          .lobes = gpu::by_rows(lobes_->buffer)},
                         {.size = extent_,
                          .stride = pair.a.extent.width,
                          .second = pair.second,
                          .grid = LobeMoments::kGrid,
                          .noise2 = noise * noise,
                          .exponent = static_cast<float>(moments_->largest_exponent()),
                          .first_row = 0},
                         {extent_.width, extent_.height});
}

void CosineLobe::write_lights(gpu::Commands& commands, std::span<const WeightedLight> lights) {
  commands.write_table(lights_, gpu::Element::vec4, rows_of(lights));
}

void CosineLobe::record_lights(gpu::Commands& commands, std::span<const WeightedLight> lights) {
  if (!has_gains_) make_gains(commands);
  write_lights(commands, lights);
  commands.dispatch(table_kernel_, {.lights = lights_, .gain = gains_, .table = table_},
                    {.lights = static_cast<int32_t>(lights.size()), .gains = 0}, {kSide * kSide});
  even_ = even_light(lights, stage_lights_);
}

void CosineLobe::record_relit(gpu::Commands& commands, const Plane& target) const {
  commands.dispatch_rows(
      relight_,
      {.full = full_->buffer,
       .lobes = lobes_->buffer,
       .lobe_values = table_,
       .picture = gpu::by_rows(target.buffer)},
      {.even = {even_[0], even_[1], even_[2], 0}, .size = extent_, .first_row = 0},
      {extent_.width, extent_.height});
}

void CosineLobe::record_sum(gpu::Commands& commands, std::span<const WeightedLight> lights,
                            const Plane& target) {
  const Rgb even = even_light(lights, stage_lights_);
  write_lights(commands, lights);
  commands.dispatch_rows(sum_,
                         {.full = full_->buffer,
                          .lobes = lobes_->buffer,
                          .lobe_values = gains_,
                          .lights = lights_,
                          .picture = gpu::by_rows(target.buffer)},
                         {.even = {even[0], even[1], even[2], 0},
                          .size = extent_,
                          .lights = static_cast<int32_t>(lights.size()),
                          .first_row = 0},
                         {extent_.width, extent_.height});
}

void CosineLobe::record_directions(gpu::Commands& commands, const Params& params,
                                   const Plane& target) const {
  commands.dispatch_rows(
      directions_,
      {.full = full_->buffer, .lobes = lobes_->buffer, .picture = gpu::by_rows(target.buffer)},
      {.size = extent_, .min_light = params.noise, .first_row = 0},
      {extent_.width, extent_.height});
}

void CosineLobe::record_responses(gpu::Commands& commands, const gpu::BufferPtr& samples,
                                  const gpu::BufferPtr& responses) const {
  const auto count = static_cast<uint32_t>(samples->count());
  commands.dispatch(respond_,
                    {.full = full_->buffer,
                     .lobes = lobes_->buffer,
                     .lobe_values = gains_,
                     .lights = stage_,
                     .samples = samples,
                     .response = responses},
                    {.samples = count, .lights = stage_lights_}, {count * stage_lights_});
}

}  // namespace inverse
