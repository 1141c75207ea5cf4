// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scale_normalization.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/image/pack4.hpp"

namespace inverse {
namespace {
using Update = shaders::solve_scale_update;
constexpr float kPoints = 400;      // about as many points are followed
constexpr uint32_t kMinLanes = 64;  // of scale_update.comp
}  // namespace

ScaleNormalization::ScaleNormalization(const std::shared_ptr<gpu::Device>& device, Extent cells)
    : cells_(cells),
      spacing_(std::max(1.0F, std::sqrt(static_cast<float>(cells.pixels()) / kPoints))),
      smooth_(device),
      track_(device),
      update_(device, {}, std::max(kMinLanes, device->variant().lone_workgroup)) {
  const auto along = [&](uint32_t length) {
    return std::max(1U, static_cast<uint32_t>(static_cast<float>(length) / spacing_));
  };
  columns_ = along(cells.width);
  rows_ = along(cells.height);
  const auto buffer = [&](uint64_t count) {
    return gpu::Buffer::create(device, gpu::Element::vec4, count);
  };
  input_ = buffer(cells.pixels());
  before_ = buffer(cells.pixels());
  now_ = buffer(cells.pixels());
  scale_ = buffer(Update::SCALE_SIZE);
  points_ = buffer(uint64_t{columns_} * rows_);
  moved_points_ = buffer(uint64_t{columns_} * rows_);
  history_ = buffer(uint64_t{columns_} * rows_ * Update::HISTORY_SPAN);
  gray_light_ = buffer(1);
  samples_ = buffer(uint64_t{columns_} * rows_ * Update::SAMPLE_STRIDE);
}

void ScaleNormalization::clear_once(gpu::Commands& commands) {
  if (!cleared_)
    for (const auto& state : {scale_, points_, moved_points_, history_, gray_light_})
      commands.fill(state);
  cleared_ = true;
}

const gpu::BufferPtr& ScaleNormalization::light_of(gpu::Commands& commands,
                                                   const gpu::BufferPtr& light) {
  clear_once(commands);
  return light ? light : gray_light_;
}

void ScaleNormalization::take(gpu::Commands& commands, const ScaleNormalization& other) {
  clear_once(commands);
  commands.copy(other.scale_, scale_, scale_->bytes());
  followed_ = false;
}

void ScaleNormalization::record(gpu::Commands& commands, const Frame& frame) {
  const gpu::BufferPtr& light = light_of(commands, frame.light);
  const bool follows = followed_ && frame.history != History::none;
  const uint32_t points = columns_ * rows_;
  commands.dispatch(smooth_, {.cells = input_, .smoothed = now_}, {.size = cells_},
                    line_of(cells_.pixels()));
  if (follows) {
    commands.dispatch(
        track_,
        {.before = before_,
         .now = now_,
         .scale = scale_,
         .points = points_,
         .moved_points = moved_points_,
         .history = history_,
         .samples = samples_,
         .light = light},
        {.size = cells_, .grid = {columns_, rows_}, .spacing = spacing_, .frame = frames_},
        {points});
    points_.swap(moved_points_);
  }
  commands.dispatch(update_,
                    {.samples = samples_,
                     .points = points_,
                     .target = frame.target,
                     .decision = frame.decision ? frame.decision : frame.target,
                     .scale = scale_,
                     .light = light},
                    {.size = cells_,
                     .count = follows ? points : 0,
                     .log_white = std::log(frame.white_level),
                     .history = static_cast<uint32_t>(frame.history)},
                    {});
  if (follows) ++frames_;
  before_.swap(now_);
  followed_ = true;
}

}  // namespace inverse
