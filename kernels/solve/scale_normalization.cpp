#include "scale_normalization.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/gpu/shaders.hpp"

INVERSE_SHADER(solve_scale_track);
INVERSE_SHADER(solve_scale_update);

namespace inverse {
namespace {
// As in scale.glsl.
constexpr uint64_t kPointStride = 2, kSampleStride = 2, kScaleSize = 3;
constexpr float kPoints = 400;   // about as many points are followed
constexpr uint32_t kLanes = 64;  // of scale_update.comp
}  // namespace

ScaleNormalization::ScaleNormalization(const std::shared_ptr<gpu::Device>& device, Extent cells)
    : cells_(cells),
      spacing_(std::max(2.0F, std::round(std::sqrt(static_cast<float>(cells.pixels()) / kPoints)))),
      track_(device->kernel(shaders::solve_scale_track)),
      update_(device->kernel(shaders::solve_scale_update, {}, kLanes)) {
  const auto along = [&](uint32_t length) {
    return std::max(1U, static_cast<uint32_t>(static_cast<float>(length) / spacing_));
  };
  columns_ = along(cells.width);
  rows_ = along(cells.height);
  const auto buffer = [&](uint64_t count) {
    return gpu::Buffer::create(device, gpu::Element::vec4, count);
  };
  before_ = buffer(cells.pixels());
  now_ = buffer(cells.pixels());
  scale_ = buffer(kScaleSize);
  points_ = buffer(uint64_t{columns_} * rows_ * kPointStride);
  samples_ = buffer(uint64_t{columns_} * rows_ * kSampleStride);
}

void ScaleNormalization::clear_once(gpu::Commands& commands) {
  if (!cleared_)
    for (const auto& state : {scale_, points_}) commands.fill(state);
  cleared_ = true;
}

void ScaleNormalization::take(gpu::Commands& commands, const ScaleNormalization& other) {
  clear_once(commands);
  commands.copy(other.scale_, scale_, scale_->bytes());
  followed_ = false;
}

void ScaleNormalization::record(gpu::Commands& commands, const Frame& frame) {
  clear_once(commands);
  const bool follows = followed_ && frame.history != History::none;
  const uint32_t points = columns_ * rows_;
  const struct {
    uint32_t width, height, columns, rows;
    float spacing;
  } track{cells_.width, cells_.height, columns_, rows_, spacing_};
  if (follows)
    commands.dispatch(track_, {before_, now_, scale_, points_, samples_}, track, {points});
  const struct {
    uint32_t points;
    float log_white;
    uint32_t history, frozen;
  } update{follows ? points : 0, std::log(frame.white_level), static_cast<uint32_t>(frame.history),
           frame.frozen ? 1U : 0U};
  commands.dispatch(
      update_, {samples_, frame.wanted, frame.decision ? frame.decision : frame.wanted, scale_},
      update, {});
  before_.swap(now_);
  followed_ = true;
}

}  // namespace inverse
