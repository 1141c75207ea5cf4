// SPDX-License-Identifier: LGPL-2.1-or-later
#include "guided_upsample.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {
namespace {

constexpr double kFlatVariance = 3e-3, kFloor = 2e-3, kMaxLight = 1e4, kDarkest = -16;

double log_intensity(const double* rgb) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) {
    const double v = std::isinf(rgb[c]) && rgb[c] > 0 ? 1 : rgb[c];
    sum += std::log((v > 0 ? std::min(v, kMaxLight) : 0) + kFloor);
  }
  return sum / 3;
}

struct Line {
  double a = 0, b = 0;
};

}  // namespace

std::vector<double> guided_upsample(const std::vector<double>& rgb, int width, int height,
                                    const std::vector<double>& half_log_shading) {
  const int w = (width + 1) / 2, h = (height + 1) / 2;
  const auto pixel = [&](int x, int y) {
    return log_intensity(
        &rgb[3 * (static_cast<size_t>(std::min(y, height - 1)) * width + std::min(x, width - 1))]);
  };
  const auto at = [&](int x, int y) {
    return static_cast<size_t>(std::clamp(y, 0, h - 1)) * w + std::clamp(x, 0, w - 1);
  };
  std::vector<double> m(static_cast<size_t>(w) * h), s(m.size());
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      m[at(x, y)] = (pixel(2 * x, 2 * y) + pixel(2 * x + 1, 2 * y) + pixel(2 * x, 2 * y + 1) +
                     pixel(2 * x + 1, 2 * y + 1)) /
                    4;
      s[at(x, y)] = std::max(half_log_shading[at(x, y)], kDarkest);
    }
  std::vector<Line> lines(m.size());
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      double mean_m = 0, mean_s = 0, variance = 0, covariance = 0;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
          mean_m += m[at(x + i, y + j)] / 9;
          mean_s += s[at(x + i, y + j)] / 9;
        }
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
          const double d = m[at(x + i, y + j)] - mean_m;
          variance += d * d / 9;
          covariance += d * (s[at(x + i, y + j)] - mean_s) / 9;
        }
      const double a = std::clamp(covariance / (variance + kFlatVariance), 0.0, 1.0);
      lines[at(x, y)] = {a, mean_s - a * mean_m};
    }
  std::vector<double> result(static_cast<size_t>(width) * height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      // Weights of a mean of three, a quarter of a half-size pixel before or behind the center.
      constexpr double kTaps[2][5] = {{1, 4, 4, 3, 0}, {0, 3, 4, 4, 1}};
      Line line;
      for (int j = -2; j <= 2; ++j)
        for (int i = -2; i <= 2; ++i) {
          const double weight = kTaps[x % 2][i + 2] * kTaps[y % 2][j + 2] / 144;
          line.a += weight * lines[at(x / 2 + i, y / 2 + j)].a;
          line.b += weight * lines[at(x / 2 + i, y / 2 + j)].b;
        }
      result[static_cast<size_t>(y) * width + x] = line.a * pixel(x, y) + line.b;
    }
  return result;
}

}  // namespace inverse::reference
