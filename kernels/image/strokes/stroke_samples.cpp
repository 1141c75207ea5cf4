// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stroke_samples.hpp"

#include <algorithm>
#include <cmath>

namespace inverse {
namespace {

constexpr float kMinMargin = 8;        // pixels
constexpr float kMarginWeight = 0.4F;  // it may show something else
constexpr float kCandidates = 4096;    // of a first, rectangular grid
constexpr float kMinAcross = 3;        // pixels of the coarsest level, rms
constexpr uint32_t kMinFrame = 8;      // pixels of that level

struct Box {
  Stroke::Point low, high;
};

/// Grid points of a spacing that lie within `reach` of a line.
std::vector<std::array<float, 3>> grid_on(const std::vector<Stroke::Point>& line, const Box& box,
                                          float step, float radius, float reach) {
  std::vector<std::array<float, 3>> found;
  for (float y = box.low[1] + step / 2; y < box.high[1]; y += step)
    for (float x = box.low[0] + step / 2; x < box.high[0]; x += step) {
      float nearest = reach * reach;
      for (size_t i = 0; i < line.size() && nearest > radius * radius; ++i)
        nearest = std::min(nearest, squared_distance({x, y}, line[i > 0 ? i - 1 : 0], line[i]));
      if (nearest < reach * reach)
        found.push_back({x, y, nearest <= radius * radius ? 1.0F : kMarginWeight});
    }
  return found;
}

}  // namespace

StrokeSamples samples_of(const Stroke& stroke, Extent frame, Extent extent) {
  const auto width = static_cast<float>(extent.width), height = static_cast<float>(extent.height);
  const float across = width / static_cast<float>(frame.width),
              down = height / static_cast<float>(frame.height);
  const float radius = stroke.radius * std::sqrt(across * down),
              reach = radius + std::max(radius / 4, kMinMargin);
  std::vector<Stroke::Point> line;
  Box box{{width, height}, {0, 0}};
  for (const Stroke::Point& point : stroke.points) {
    line.push_back({point[0] * across, point[1] * down});
    for (size_t axis = 0; axis < 2; ++axis) {
      box.low[axis] = std::min(box.low[axis], line.back()[axis] - reach);
      box.high[axis] = std::max(box.high[axis], line.back()[axis] + reach);
    }
  }
  box = {{std::max(box.low[0], 0.0F), std::max(box.low[1], 0.0F)},
         {std::min(box.high[0], width), std::min(box.high[1], height)}};
  StrokeSamples result;
  if (!(box.low[0] < box.high[0] && box.low[1] < box.high[1])) return result;
  float step = std::max(
      1.0F, std::sqrt((box.high[0] - box.low[0]) * (box.high[1] - box.low[1]) / kCandidates));
  auto found = grid_on(line, box, step, radius, reach);
  while (found.size() > StrokeSamples::kMax) {
    step *= 1.02F * std::sqrt(static_cast<float>(found.size()) / StrokeSamples::kMax);
    found = grid_on(line, box, step, radius, reach);
  }
  if (found.empty()) return result;
  std::array<double, 2> sum{};
  for (const auto& sample : found)
    for (size_t axis = 0; axis < 2; ++axis) sum[axis] += static_cast<double>(sample[axis]);
  const auto count = static_cast<double>(found.size());
  for (size_t axis = 0; axis < 2; ++axis)
    result.center[axis] = static_cast<float>(sum[axis] / count);
  double squares = 0;
  for (const auto& [x, y, weight] : found) {
    const float u = x - result.center[0], v = y - result.center[1];
    result.samples.push_back({u, v, weight, 0});
    squares += static_cast<double>(u * u + v * v);
  }
  result.radius = std::max(static_cast<float>(std::sqrt(squares / count)), 1.0F);
  while (result.levels < StrokeSamples::kMaxLevel &&
         result.radius > kMinAcross * static_cast<float>(2U << result.levels) &&
         std::min(extent.width, extent.height) >> (result.levels + 1) >= kMinFrame)
    ++result.levels;
  return result;
}

}  // namespace inverse
