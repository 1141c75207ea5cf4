// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene_light.hpp"

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
static_assert(4 * (Scene::LIGHT_SIZE - Scene::LIGHT_VOTES) >= Scene::CANDIDATES);

}  // namespace

std::span<const float> SceneLight::weights() {
  return {kLightColorWeights, kLightColorWeights_size};
}

std::string SceneLight::skipped(const Params& params, Did did) {
  if (!params.colored()) return "color of light: light-color-slope=0 makes it gray";
  if (params.slope) return "measuring the color of light: light-color-slope gives it";
  switch (did) {
    case Did::measured:
      return {};
    case Did::reused:
      return "measuring the color of light: it is due every " + std::to_string(kPeriod) + " frames";
    case Did::no_color:
      return "measuring the color of light: the frame has no color";
    case Did::no_contrast:
      return "measuring the color of light: the frame has no contrast";
  }
  return {};
}

SceneLight::SceneLight(const std::shared_ptr<gpu::Device>& device, Extent extent)
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
  probe_ = Buffer::create(device, Element::vec4, half_of(half_of(cells_)).pixels());
  points_ = Buffer::create(device, Element::vec4, cells_.pixels());
  coarse_points_ = Buffer::create(device, Element::vec4, coarse_);
  cloud_ = Buffer::create(device, Element::scalar, Scene::CLOUD_COUNT);
  counts_ = Buffer::create(device, Element::word, Scene::STEP_COUNT);
  features_ = Buffer::create(device, Element::scalar, Scene::STEP_COUNT);
  hidden_ = Buffer::create(device, Element::scalar, Scene::NET_HIDDEN);
  arguments_ = Buffer::create(device, Element::word, 3 * Scene::MEASURE_KERNELS);
  light_ = Buffer::create(device, Element::vec4, Scene::LIGHT_SIZE);
  if (weights().size() != Scene::NET_SIZE)
    throw Error(ErrorKind::internal, "weights of another network than light.glsl has");
  weights_ = gpu::make_table(device, Element::scalar, std::as_bytes(std::span(weights())));
}

void SceneLight::record(gpu::Commands& commands, const gpu::BufferPtr& frame, const Params& params,
                        bool first) {
  first |= frames_ == 0;  // buffers are not cleared yet
  if (first) {
    frames_ = 0;
    for (const auto& state : {light_, cloud_, counts_}) commands.fill(state);
  }
  const Extent probe = half_of(half_of(cells_));
  commands.dispatch(points_kernel_, {.frame = frame, .points = probe_},
                    {.size = extent_, .cells = probe, .factor = 4 * factor_},
                    line_of(probe.pixels()));
  const auto groups = [](const auto& program, uint64_t items) {
    return static_cast<uint32_t>((items - 1) / program.kernel()->workgroup() + 1);
  };
  commands.dispatch(scene_,
                    {.points = probe_, .light = light_, .cloud = cloud_, .arguments = arguments_},
                    {.count = static_cast<uint32_t>(probe.pixels()),
                     .first = first,
                     .due = frames_++ % kPeriod == 0,
                     .automatic = !params.slope,
                     .slope = std::clamp(params.slope.value_or(0.0F), -kMaxSlope, kMaxSlope),
                     .groups = {groups(points_kernel_, cells_.pixels()), groups(levels_, coarse_),
                                groups(steps_, count_), groups(features_kernel_, Scene::STEP_COUNT),
                                groups(votes_, Scene::NET_HIDDEN)}},
                    {});
  if (!params.slope) measure(commands, frame);
  decided_ = false;
}

void SceneLight::record_move(gpu::Commands& commands, bool reuses) {
  if (!std::exchange(decided_, true) && !reuses) commands.dispatch(move_, {.light = light_}, {});
}

void SceneLight::measure(gpu::Commands& commands, const gpu::BufferPtr& frame) {
  const auto at = [](uint32_t kernel) { return uint64_t{3} * sizeof(uint32_t) * kernel; };
  commands.dispatch_indirect(points_kernel_, {.frame = frame, .points = points_},
                             {.size = extent_, .cells = cells_, .factor = factor_}, arguments_,
                             at(Scene::MEASURE_POINTS));
  commands.dispatch_indirect(levels_, {.fine = points_, .coarse = coarse_points_},
                             {.cells = cells_}, arguments_, at(Scene::MEASURE_LEVELS));
  commands.dispatch_indirect(steps_, {.fine = points_, .coarse = coarse_points_, .counts = counts_},
                             {.cells = cells_}, arguments_, at(Scene::MEASURE_STEPS));
  commands.dispatch_indirect(features_kernel_, {.counts = counts_, .features = features_},
                             {.cells = cells_}, arguments_, at(Scene::MEASURE_FEATURES));
  commands.dispatch_indirect(votes_,
                             {.features = features_, .weights = weights_, .hidden = hidden_},
                             arguments_, at(Scene::MEASURE_VOTES));
  commands.dispatch_indirect(
      decide_, {.hidden = hidden_, .weights = weights_, .cloud = cloud_, .light = light_},
      {.rate = kRate}, arguments_, at(Scene::MEASURE_DECIDE));
}

PlanePtr SceneLight::record_slope(gpu::Commands& commands, const gpu::BufferPtr& scale) {
  PlanePtr slope = slopes_.acquire();
  commands.dispatch(white_, {.light = light_, .scale = scale, .slope = slope->buffer}, {});
  return slope;
}

}  // namespace inverse
