// SPDX-License-Identifier: LGPL-2.1-or-later
#include "global_tint.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference::global {
namespace {

/// Sums over windows of 2 radius + 1 points a side, cut at the border.
template <class Value>
std::vector<double> box(int width, int height, int radius, const Value& value) {
  std::vector<double> rows(std::size_t(width) * std::size_t(height)), out(rows.size());
  const auto at = [&](int x, int y) {
    return std::size_t(y) * std::size_t(width) + std::size_t(x);
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int u = std::max(0, x - radius); u <= std::min(width - 1, x + radius); ++u)
        rows[at(x, y)] += value(at(u, y));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int v = std::max(0, y - radius); v <= std::min(height - 1, y + radius); ++v)
        out[at(x, y)] += rows[at(x, v)];
  return out;
}

constexpr double kMinConfidence = 0.05;  // of a window's points

}  // namespace

double label_confidence(const Chroma& residual, double fraction, const TintStatistics& statistics,
                        const TintParams& params) {
  const double tint = params.tint_sigma * statistics.full * fraction;
  return std::exp(-norm2(residual) /
                  (2 * (params.residual_sigma * params.residual_sigma + tint * tint)));
}

TintStatistics tint_statistics(const std::vector<Chroma>& tint, const std::vector<double>& fraction,
                               const std::vector<double>& weight, const TintParams& params) {
  double t2 = 0, f2 = 1e-9, weighted = 0, all = 1e-9;
  for (std::size_t i = 0; i < tint.size(); ++i) {
    t2 += norm2(tint[i]);
    f2 += fraction[i] * fraction[i];
    weighted += weight[i] * norm2(tint[i]);
    all += weight[i];
  }
  const double scene = weighted / all;
  return {std::sqrt(t2 / f2), params.residual * scene / (scene + params.gate)};
}

Residual residual_field(const std::vector<Chroma>& raw, const std::vector<double>& fraction,
                        int width, int height, const TintStatistics& statistics,
                        const TintParams& params) {
  const std::size_t n = raw.size();
  const int radius = std::max(1, int(std::lround(params.window * width)));
  std::vector<double> c(n);
  for (std::size_t i = 0; i < n; ++i)
    c[i] = label_confidence(raw[i], fraction[i], statistics, params);
  const auto windows = box(width, height, radius, [](std::size_t) { return 1.0; });
  const auto confidence = box(width, height, radius, [&](std::size_t i) { return c[i]; });
  Residual out;
  out.slope.resize(n), out.offset.resize(n), out.smooth.resize(n);
  for (std::size_t d = 0; d < 2; ++d) {
    const auto sum = box(width, height, radius, [&](std::size_t i) { return c[i] * raw[i][d]; });
    std::vector<double> e(n), slope(n), offset(n);
    for (std::size_t i = 0; i < n; ++i) {
      out.smooth[i][d] = sum[i] / (confidence[i] + kMinConfidence * windows[i]);
      e[i] = c[i] * raw[i][d] + (1 - c[i]) * out.smooth[i][d];
    }
    const auto first = box(width, height, radius, [&](std::size_t i) { return c[i] * e[i]; });
    const auto second =
        box(width, height, radius, [&](std::size_t i) { return c[i] * e[i] * e[i]; });
    for (std::size_t i = 0; i < n; ++i) {
      const double all = confidence[i] + 1e-6, middle = first[i] / all;
      const double variance = std::max(0.0, second[i] / all - middle * middle);
      slope[i] = variance / (variance + params.edge);
      offset[i] = (1 - slope[i]) * middle;
    }
    const auto slopes = box(width, height, radius, [&](std::size_t i) { return c[i] * slope[i]; });
    const auto offsets =
        box(width, height, radius, [&](std::size_t i) { return c[i] * offset[i]; });
    for (std::size_t i = 0; i < n; ++i) {
      out.slope[i][d] = slopes[i] / (confidence[i] + 1e-6);
      out.offset[i][d] = offsets[i] / (confidence[i] + 1e-6);
    }
  }
  return out;
}

}  // namespace inverse::reference::global
