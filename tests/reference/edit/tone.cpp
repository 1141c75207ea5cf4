// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tone.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {
namespace {

constexpr double kShadingFloor = 1.0 / 512;
constexpr double kMaxGain = 60;
constexpr double kLargest = 65504;
constexpr unsigned kSampleSide = 64;

/// Slopes at the points.
std::vector<double> slopes(const std::vector<TonePoint>& points) {
  const size_t n = points.size();
  std::vector<double> secant(n - 1), slope(n);
  for (size_t i = 0; i + 1 < n; ++i)
    secant[i] = (points[i + 1].y - points[i].y) / (points[i + 1].x - points[i].x);
  slope.front() = secant.front();
  slope.back() = secant.back();
  for (size_t i = 1; i + 1 < n; ++i)
    slope[i] = secant[i - 1] * secant[i] > 0 ? (secant[i - 1] + secant[i]) / 2 : 0;
  for (size_t i = 0; i + 1 < n; ++i) {
    if (secant[i] == 0) {
      slope[i] = slope[i + 1] = 0;
      continue;
    }
    const double alpha = slope[i] / secant[i], beta = slope[i + 1] / secant[i];
    const double square = alpha * alpha + beta * beta;
    if (square > 9) {
      const double tau = 3 / std::sqrt(square);
      slope[i] = tau * alpha * secant[i];
      slope[i + 1] = tau * beta * secant[i];
    }
  }
  return slope;
}

}  // namespace

double tone_curve(const std::vector<TonePoint>& points, double x) {
  const auto slope = slopes(points);
  if (x < points.front().x) return points.front().y + slope.front() * (x - points.front().x);
  if (x >= points.back().x) return points.back().y + slope.back() * (x - points.back().x);
  size_t i = 0;
  while (x >= points[i + 1].x) ++i;
  const double h = points[i + 1].x - points[i].x, t = (x - points[i].x) / h;
  const double h00 = (1 + 2 * t) * (1 - t) * (1 - t), h10 = t * (1 - t) * (1 - t);
  const double h01 = t * t * (3 - 2 * t), h11 = t * t * (t - 1);
  return h00 * points[i].y + h10 * h * slope[i] + h01 * points[i + 1].y + h11 * h * slope[i + 1];
}

ToneLevel tone_level(const std::vector<Rgba>& layers, const std::vector<double>& matte,
                     unsigned width, unsigned height) {
  const unsigned columns = std::min(width, kSampleSide), rows = std::min(height, kSampleSide);
  double sum = 0, weights = 0;
  for (unsigned j = 0; j < rows; ++j)
    for (unsigned i = 0; i < columns; ++i) {
      const size_t n = size_t{j * height / rows} * width + i * width / columns;
      const double s = finite(layers[n])[3];
      if (s <= kShadingFloor) continue;
      const double weight = matte.empty() ? 1 : std::min(finite(matte[n]), 1.0);
      sum += weight * std::log2(s);
      weights += weight;
    }
  if (weights <= 0) return {};
  return {sum / weights, true};
}

ToneLevel follow(const ToneLevel& before, const ToneLevel& measured) {
  if (!measured.known) return before;
  const double apart = measured.log2_middle - before.log2_middle;
  if (!before.known || std::abs(apart) >= 1) return measured;
  return {before.log2_middle + apart / 8, true};
}

Rgba tone(const Rgba& layers, double share, const std::vector<TonePoint>& points,
          double log2_middle) {
  Rgba result = finite(layers);
  const double x = std::log2(std::max(result[3], kShadingFloor)) - log2_middle;
  const double gain = std::clamp(tone_curve(points, x) - x, -kMaxGain, kMaxGain);
  result[3] = std::min(result[3] * std::exp2(share * gain), kLargest);
  return result;
}

}  // namespace inverse::reference
