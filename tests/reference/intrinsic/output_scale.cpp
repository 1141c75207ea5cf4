// SPDX-License-Identifier: LGPL-2.1-or-later
#include "output_scale.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {

namespace {

/// Means of 2 x 2; at an odd border the last row or column counts twice, as in the guide.
std::vector<double> halved(const std::vector<double>& plane, const GuideLevel& fine,
                           const GuideLevel& coarse) {
  std::vector<double> means;
  for (int y = 0; y < coarse.height; ++y)
    for (int x = 0; x < coarse.width; ++x) {
      double sum = 0;
      for (const int j : {2 * y, 2 * y + 1})
        for (const int i : {2 * x, 2 * x + 1}) sum += plane[fine.index(i, j)];
      means.push_back(sum / 4);
    }
  return means;
}

/// The mean over ranks around the quantile, half of what lies above it wide on either side.
double bright_end(std::vector<double> values, double quantile) {
  std::sort(values.begin(), values.end());
  const auto total = static_cast<double>(values.size());
  const double center = quantile * total, reach = std::max((total - center) / 2, 0.5);
  const double low = std::clamp(center - reach, 0.0, total - 0.5);
  const double high = std::min(center + reach, total);
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto rank = static_cast<double>(i);
    sum += std::max(std::min(rank + 1, high) - std::max(rank, low), 0.0) * values[i];
  }
  return sum / (high - low);
}

}  // namespace

double OutputScale::update(const Guide& guide, const std::vector<double>& log_shading, bool carries,
                           const LightColor& light) {
  const GuideLevel& cells = guide.level[kCellLevel];
  std::vector<double> mean = log_shading;
  for (int level = 0; level < kCellLevel; ++level)
    mean = halved(mean, guide.level[std::size_t(level)], guide.level[std::size_t(level) + 1]);
  std::vector<double> brightest;  // ln max_c R
  double white = 0, weights = 0;  // ln S of the brightest cells
  for (std::size_t i = 0; i < cells.m.size(); ++i)
    if (const double seen = cells.m[i] + cells.u[i]; seen > kDarkest) {
      brightest.push_back(std::clamp(seen - mean[i], -kBrightnessReach, kBrightnessReach));
      const double steep = std::exp(8 * (cells.m[i] - light.reference));
      const double weight = std::floor(256 * std::min(steep, 1.0) + 0.5);
      white += weight * std::clamp(mean[i], -kBrightnessReach, kBrightnessReach);
      weights += weight;
    }
  std::vector<ScaleCell> states;
  for (std::size_t i = 0; i < cells.m.size(); ++i) {
    // The mean channel, of logs of the channels less their mean.
    const double green = cells.c1[i] / 3 - cells.c0[i] / std::sqrt(3);
    const double red = cells.c1[i] / 3 + cells.c0[i] / std::sqrt(3), blue = -2 * cells.c1[i] / 3;
    const double brightness =
        cells.m[i] + std::log((std::exp(red) + std::exp(green) + std::exp(blue)) / 3);
    states.push_back({cells.m[i], cells.c0[i], cells.c1[i], brightness - mean[i]});
  }
  if (!normalization_) normalization_.emplace(cells.width, cells.height);
  target_ = {0, brightest.empty()};
  if (!target_.dark)
    target_ = {-bright_end(brightest, params_.quantile), false, weights > 0 ? white / weights : 0};
  return normalization_->update(states, target_, carries, params_.white_level, light);
}

}  // namespace inverse::reference
