// SPDX-License-Identifier: LGPL-2.1-or-later
#include "keyframes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace inverse {
namespace {

constexpr double kNew = 0.12;  // distance from all others from which on a frame is one of them
constexpr double kInverseDepth = 0.2;  // 1/m

double mean_of(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) /
         static_cast<double>(std::max<size_t>(values.size(), 1));
}

}  // namespace

double Keyframes::distance(const Picture& a, const Picture& b) {
  const double offset = mean_of(a.brightness) - mean_of(b.brightness);
  double sum = 0;
  for (size_t i = 0; i < a.brightness.size(); ++i) {
    sum += std::min(std::abs(double{a.brightness[i]} - double{b.brightness[i]} - offset), 1.0);
    const double za = double{a.depth[i]}, zb = double{b.depth[i]};
    if (za > 0 && zb > 0)
      sum += std::min(std::abs(1 / za - 1 / zb) / kInverseDepth, 1.0);
    else if (za > 0 || zb > 0)
      sum += 1;
  }
  return sum / static_cast<double>(std::max<size_t>(2 * a.brightness.size(), 1));
}

void Keyframes::add(const Picture& picture, const Pose& pose) {
  if (frames_.size() >= limit_) return;
  if (std::ranges::all_of(
          frames_, [&](const Frame& frame) { return distance(frame.picture, picture) > kNew; }))
    frames_.push_back({picture, pose});
}

std::vector<Pose> Keyframes::like(const Picture& picture, size_t count) const {
  std::vector<std::pair<double, size_t>> order;
  for (size_t i = 0; i < frames_.size(); ++i)
    order.emplace_back(distance(frames_[i].picture, picture), i);
  std::ranges::sort(order);
  std::vector<Pose> poses;
  for (size_t i = 0; i < std::min(count, order.size()); ++i)
    poses.push_back(frames_[order[i].second].pose);
  return poses;
}

}  // namespace inverse
