#include "light_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "../gpu/shaders.hpp"
#include "../intrinsic/quads.hpp"

INVERSE_SHADER(global_grid);
INVERSE_SHADER(global_scene);
INVERSE_SHADER(global_emit);
INVERSE_SHADER(global_blur);
INVERSE_SHADER(global_receive);
INVERSE_SHADER(global_gather);
INVERSE_SHADER(global_amount);
INVERSE_SHADER(global_kappa);
INVERSE_SHADER(global_light);
INVERSE_SHADER(global_modes);
INVERSE_SHADER(global_residual);
INVERSE_SHADER(global_window);
INVERSE_SHADER(global_tint);
INVERSE_SHADER(global_split);

namespace inverse {
namespace {

constexpr uint32_t kBins = 64 * 64;    // of the chroma histogram, as in global.glsl
constexpr uint32_t kCandidates = 16;   // amounts
constexpr uint32_t kSceneSize = 4;     // vec4
constexpr float kNeutralWidth = 0.2F;  // log chroma
constexpr float kWindow = 0.05F;       // radius of the residual's windows, of the grid's width

uint32_t factor_of(Extent extent) {
  uint32_t factor = 1;
  while ((std::max(extent.width, extent.height) + factor - 1) / factor > LightModel::kMostPoints)
    factor *= 2;
  return factor;
}

Extent divided(Extent extent, uint32_t by) {
  return {(extent.width + by - 1) / by, (extent.height + by - 1) / by};
}

gpu::Items line(uint64_t items) { return {static_cast<uint32_t>(items)}; }

std::array<uint32_t, 2> size(Extent extent) { return {extent.width, extent.height}; }

}  // namespace

LightModel::LightModel(std::shared_ptr<gpu::Device> device, Extent extent)
    : extent_(extent),
      grid_(divided(extent, factor_of(extent))),
      half_(divided(grid_, 2)),
      factor_(factor_of(extent)) {
  const uint32_t lone = device->variant().lone_workgroup;
  grid_kernel_ = device->kernel(shaders::global_grid);
  scene_kernel_ = device->kernel(shaders::global_scene, {}, lone);
  emit_ = device->kernel(shaders::global_emit);
  rows_ = device->kernel(shaders::global_blur, {0});
  columns_ = device->kernel(shaders::global_blur, {1});
  receive_ = device->kernel(shaders::global_receive);
  gather_ = device->kernel(shaders::global_gather);
  amount_ = device->kernel(shaders::global_amount, {}, lone);
  kappa_ = device->kernel(shaders::global_kappa);
  light_ = device->kernel(shaders::global_light);
  modes_ = device->kernel(shaders::global_modes, {}, lone);
  residual_kernel_ = device->kernel(shaders::global_residual);
  believe_ = device->kernel(shaders::global_window, {0});
  fit_ = device->kernel(shaders::global_window, {1});
  average_ = device->kernel(shaders::global_window, {2});
  tint_ = device->kernel(shaders::global_tint, {factor_ >= 8 ? 1U : 0U});
  split_ = device->kernel(shaders::global_split);

  using gpu::Element;
  const auto buffer = [&](Element element, uint64_t count) {
    return gpu::Buffer::create(device, element, count);
  };
  for (auto* plane : {&points_, &cues_, &cues_before_, &lights_, &lit_, &residual_, &believed_,
                      &means_, &models_, &averaged_})
    *plane = buffer(Element::vec4, grid_.pixels());
  for (auto* plane : {&emitted_, &blurred_, &received_})
    *plane = buffer(Element::vec4, kSlots * half_.pixels());
  scene_ = buffer(Element::vec4, kSceneSize);
  labels_ = buffer(Element::word, grid_.pixels());
  costs_ = buffer(Element::scalar, kCandidates);
  carried_costs_ = buffer(Element::scalar, kCandidates);
  histogram_ = buffer(Element::word, kBins);
  carried_ = buffer(Element::scalar, kBins);
  heights_ = buffer(Element::scalar, 2UL * kBins);
  words_ = buffer(Element::word, 4UL * kBins);
  table_ = buffer(Element::word, kBins);
  base_ = buffer(Element::vec4, kSlots + 1);
}

void LightModel::gather(gpu::Commands& commands, const Params& params) {
  const uint64_t planes = kSlots * half_.pixels();
  commands.dispatch(emit_, {points_, labels_, scene_, emitted_}, size(grid_), line(planes));
  const float sigma = params.reach * static_cast<float>(half_.width);
  const int reach = static_cast<int>(std::ceil(3 * sigma));
  float sum = 0;
  for (int d = -reach; d <= reach; ++d)
    sum += std::exp(-0.5F * static_cast<float>(d * d) / (sigma * sigma));
  const struct {
    uint32_t width, height;
    float sigma, norm;
    int32_t reach;
  } blur{half_.width, half_.height, sigma, 1 / sum, reach};
  commands.dispatch(rows_, {emitted_, blurred_}, blur, line(planes));
  commands.dispatch(columns_, {blurred_, emitted_}, blur, line(planes));
  const struct {
    uint32_t count;
    float near, own;
  } receive{static_cast<uint32_t>(half_.pixels()), params.near, params.own};
  commands.dispatch(receive_, {emitted_, scene_, received_}, receive, line(half_.pixels()));
  commands.dispatch(gather_, {points_, cues_, labels_, received_, scene_, lights_}, size(grid_),
                    line(grid_.pixels()));
}

void LightModel::weigh(gpu::Commands& commands, const Params& params) {
  const auto count = static_cast<uint32_t>(grid_.pixels());
  const struct {
    uint32_t count;
    float neutral, width;
  } amount{count, params.neutral, -0.5F / (kNeutralWidth * kNeutralWidth)};
  commands.dispatch(amount_, {cues_, lights_, costs_}, amount,
                    {kCandidates * amount_->workgroup()});
  const struct {
    float manual, typical, spread, trust;
  } kappa{params.amount, params.typical_amount, params.amount_spread, params.trust};
  commands.dispatch(kappa_, {costs_, carried_costs_, scene_}, kappa, {1});
  commands.fill(histogram_);
  commands.dispatch(light_, {cues_, lights_, scene_, lit_, histogram_}, count, line(count));
  const struct {
    uint32_t count;
    float least_share, same, gate;
  } modes{count, params.least_share, params.same_color, params.gate};
  commands.dispatch(modes_, {histogram_, lit_, carried_, heights_, words_, table_, base_, scene_},
                    modes, {1});
}

void LightModel::smooth(gpu::Commands& commands, const Params& params) {
  const auto count = static_cast<uint32_t>(grid_.pixels());
  commands.dispatch(residual_kernel_, {cues_, lit_, table_, base_, scene_, residual_, labels_},
                    count, line(count));
  const struct {
    uint32_t width, height;
    int32_t radius;
    float edge;
  } window{grid_.width, grid_.height,
           std::max(1, static_cast<int>(std::lround(kWindow * static_cast<float>(grid_.width)))),
           params.edge};
  commands.dispatch(believe_, {residual_, residual_, lit_, believed_, means_}, window, line(count));
  commands.dispatch(fit_, {believed_, residual_, lit_, models_, means_}, window, line(count));
  commands.dispatch(average_, {models_, residual_, lit_, averaged_, means_}, window, line(count));
}

void LightModel::record(gpu::Commands& commands, const PlanePtr& frame, const Before& before,
                        bool first, const Params& params, const PlanePtr& plain,
                        const PlanePtr& tints) {
  if (!cleared_)
    for (const auto& buffer : {scene_, labels_, carried_costs_, carried_, base_, cues_before_})
      commands.fill(buffer);
  cleared_ = true;
  const struct {
    uint32_t width, height, factor, first;
  } grid{extent_.width, extent_.height, factor_, first ? 1U : 0U};
  commands.dispatch(grid_kernel_,
                    {frame->buffer, before.memory, before.shading, before.gauge, points_, cues_},
                    grid, line(grid_.pixels()));
  const struct {
    uint32_t count, first;
    float renew, cut;
  } scene{static_cast<uint32_t>(grid_.pixels()), first ? 1U : 0U, params.renew, params.cut};
  commands.dispatch(scene_kernel_, {points_, cues_, cues_before_, scene_}, scene, {1});
  gather(commands, params);
  commands.stage("gather");
  weigh(commands, params);
  commands.stage("amount");
  smooth(commands, params);
  const struct { uint32_t width, height, factor; } tint{extent_.width, extent_.height, factor_};
  commands.dispatch(tint_,
                    {frame->buffer, before.memory, before.shading, before.gauge, scene_, means_,
                     averaged_, received_, table_, base_, plain->buffer, tints->buffer},
                    tint, line(quads_of(extent_)));
  cues_.swap(cues_before_);
  commands.stage("tint");
}

void LightModel::record_split(gpu::Commands& commands, const PlanePtr& frame,
                              const PlanePtr& intrinsic, const PlanePtr& tints,
                              const PlanePtr& layers, const PlanePtr& reflectance) {
  const struct { uint32_t width, height, factor; } push{extent_.width, extent_.height, factor_};
  commands.dispatch(split_,
                    {frame->buffer, intrinsic->buffer, tints->buffer, received_, base_, scene_,
                     layers->buffer, reflectance->buffer},
                    push, line(quads_of(extent_)));
  commands.stage("split");
}

}  // namespace inverse
