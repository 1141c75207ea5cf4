// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_color.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "common/error.hpp"
#include "kernels/gpu/reduce.hpp"
#include "kernels/image/pack4.hpp"
#include "kernels/image/pyramid.hpp"

namespace inverse {

extern const float kLightColorWeights[];
extern const std::size_t kLightColorWeights_size;

namespace {
using Scene = shaders::intrinsic_light_color_scene;
constexpr uint32_t kLanes = 8;      // of kernels that work on one
constexpr float kRate = 1.0F / 16;  // least share of a measurement in the scene's slope
constexpr uint64_t kArguments = 3 * sizeof(uint32_t);  // of a kernel

uint32_t groups_of(const gpu::KernelPtr& kernel, uint32_t items) {
  return (items - 1) / kernel->workgroup() + 1;
}
}  // namespace

std::span<const float> LightColor::weights() {
  return {kLightColorWeights, kLightColorWeights_size};
}

std::string LightColor::skipped(const Params& params, std::optional<Did> before) {
  if (!params.colored()) return "color of light: light-color-slope=0 makes it gray";
  if (params.slope) return "measuring the color of light: light-color-slope gives it";
  if (before == Did::no_color) return "measuring the color of light: the frame has no color";
  if (before == Did::no_contrast) return "measuring the color of light: the frame has no contrast";
  if (before == Did::reused)
    return "measuring the color of light: it is due every " + std::to_string(kPeriod) + " frames";
  return {};
}

LightColor::LightColor(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : extent_(extent),
      factor_((std::max(extent.width, extent.height) + Scene::LIGHT_POINTS - 1) /
              Scene::LIGHT_POINTS),
      points_kernel_(device),
      levels_(device),
      scene_(device, {}, device->variant().lone_workgroup),
      steps_(device),
      features_kernel_(device),
      votes_(device),
      decide_(device, {}, device->variant().lone_workgroup),
      move_(device, {}, kLanes),
      white_(device, {}, kLanes),
      slopes_(device, {1, 1}) {
  const auto cells = [&](uint32_t length) { return (length + factor_ - 1) / factor_; };
  cells_ = {cells(extent.width), cells(extent.height)};
  coarse_ = 0;
  Extent level = cells_;
  for (uint32_t k = 1; k < Scene::LIGHT_LEVELS; ++k) {
    level = half_of(level);
    coarse_ += static_cast<uint32_t>(level.pixels());
  }
  count_ = static_cast<uint32_t>(cells_.pixels()) + coarse_;
  using gpu::Buffer;
  using gpu::Element;
  points_ = Buffer::create(device, Element::vec4, cells_.pixels());
  coarse_points_ = Buffer::create(device, Element::vec4, coarse_);
  cloud_ = Buffer::create(device, Element::scalar, Scene::CLOUD_COUNT);
  counts_ = Buffer::create(device, Element::word, Scene::STEP_COUNT);
  features_ = Buffer::create(device, Element::scalar, Scene::STEP_COUNT);
  hidden_ = Buffer::create(device, Element::scalar, Scene::NET_HIDDEN);
  arguments_ = Buffer::create(device, Element::word, 4 * kArguments / sizeof(uint32_t));
  light_ = Buffer::create(device, Element::vec4, Scene::LIGHT_SIZE);
  if (weights().size() != Scene::NET_SIZE)
    throw Error(ErrorKind::internal, "weights of another network than light.glsl has");
  weights_ = Buffer::create(device, Element::scalar, Scene::NET_SIZE, gpu::Memory::upload);
  memcpy(weights_->map(), weights().data(), weights().size_bytes());
}

void LightColor::record(gpu::Commands& commands, const gpu::BufferPtr& frame, const Params& params,
                        bool first) {
  if (first) {
    frames_ = 0;
    for (const auto& state : {light_, cloud_, counts_}) commands.fill(state);
  }
  commands.dispatch(points_kernel_, {.frame = frame, .points = points_},
                    {.size = extent_, .cells = cells_, .factor = factor_},
                    line_of(cells_.pixels()));
  commands.dispatch(levels_, {.fine = points_, .coarse = coarse_points_}, {.cells = cells_},
                    {coarse_});
  commands.dispatch(
      scene_, {.coarse = coarse_points_, .light = light_, .cloud = cloud_, .arguments = arguments_},
      {.count = static_cast<uint32_t>(half_of(cells_).pixels()),
       .first = first,
       .due = frames_++ % kPeriod == 0,
       .automatic = !params.slope,
       .slope = std::clamp(params.slope.value_or(0.0F), -kMaxSlope, kMaxSlope),
       .groups_steps = groups_of(steps_.kernel(), count_),
       .groups_features = groups_of(features_kernel_.kernel(), Scene::STEP_COUNT),
       .groups_votes = groups_of(votes_.kernel(), Scene::NET_HIDDEN)},
      {});
  if (!params.slope) measure(commands);
  moved_ = false;
}

void LightColor::record_move(gpu::Commands& commands) {
  if (!std::exchange(moved_, true)) commands.dispatch(move_, {.light = light_}, {});
}

void LightColor::measure(gpu::Commands& commands) {
  commands.dispatch_indirect(steps_, {.fine = points_, .coarse = coarse_points_, .counts = counts_},
                             {.cells = cells_}, arguments_);
  commands.dispatch_indirect(features_kernel_, {.counts = counts_, .features = features_},
                             {.cells = cells_}, arguments_, kArguments);
  commands.dispatch_indirect(votes_,
                             {.features = features_, .weights = weights_, .hidden = hidden_},
                             arguments_, 2 * kArguments);
  commands.dispatch_indirect(
      decide_, {.hidden = hidden_, .weights = weights_, .cloud = cloud_, .light = light_},
      {.rate = kRate}, arguments_, 3 * kArguments);
}

PlanePtr LightColor::record_slope(gpu::Commands& commands, const gpu::BufferPtr& scale) {
  PlanePtr slope = slopes_.acquire();
  commands.dispatch(white_, {.light = light_, .scale = scale, .slope = slope->buffer}, {});
  return slope;
}

}  // namespace inverse
