// SPDX-License-Identifier: LGPL-2.1-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "detail.hpp"
#include "metrics.hpp"

namespace inverse::bench {
namespace {

using detail::counts;
using detail::kMinEnergy;

/// Sums over the counting pixels of a window of one channel.
struct Sums {
  double ee = 0, et = 0, tt = 0;
};

Sums sums(const Image& estimate, const Image& truth, const Image& mask, int c, int x0, int y0,
          int x1, int y1) {
  Sums s;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      if (!counts(mask, x, y)) continue;
      const double e = estimate.at(x, y, c), t = truth.at(x, y, c);
      s.ee += e * e, s.et += e * t, s.tt += t * t;
    }
  return s;
}

}  // namespace

double mse(const Image& estimate, const Image& truth, const Image& mask) {
  detail::check_sizes(estimate, truth, mask);
  double error = 0, count = 0;
  for (int y = 0; y < truth.height; ++y)
    for (int x = 0; x < truth.width; ++x)
      for (int c = 0; counts(mask, x, y) && c < truth.channels; ++c) {
        const double d = double(estimate.at(x, y, c)) - truth.at(x, y, c);
        error += d * d, count += 1;
      }
  return count > 0 ? error / count : 0.0;
}

double psnr(const Image& estimate, const Image& truth, const Image& mask, double peak) {
  const double error = mse(estimate, truth, mask);
  return error > 0 ? 10 * std::log10(peak * peak / error) : std::numeric_limits<double>::infinity();
}

Image fitted(const Image& estimate, const Image& truth, const Image& mask, double* peak) {
  detail::check_sizes(estimate, truth, mask);
  double max = 0;
  for (int y = 0; y < truth.height; ++y)
    for (int x = 0; x < truth.width; ++x)
      for (int c = 0; counts(mask, x, y) && c < truth.channels; ++c)
        max = std::max<double>(max, truth.at(x, y, c));
  max = std::max(max, 1e-9);
  if (peak) *peak = max;
  Image out(truth.width, truth.height, truth.channels);
  for (int c = 0; c < truth.channels; ++c) {
    const Sums s = sums(estimate, truth, mask, c, 0, 0, truth.width, truth.height);
    const double scale = s.ee > kMinEnergy ? s.et / s.ee / max : 0.0;
    for (int y = 0; y < truth.height; ++y)
      for (int x = 0; x < truth.width; ++x) out.at(x, y, c) = float(scale * estimate.at(x, y, c));
  }
  return out;
}

double scale_invariant_mse(const Image& estimate, const Image& truth, const Image& mask) {
  double peak = 1;
  const Image e = fitted(estimate, truth, mask, &peak);
  double error = 0, count = 0;
  for (int y = 0; y < truth.height; ++y)
    for (int x = 0; x < truth.width; ++x)
      for (int c = 0; counts(mask, x, y) && c < truth.channels; ++c) {
        const double d = e.at(x, y, c) - truth.at(x, y, c) / peak;
        error += d * d, count += 1;
      }
  return count > 0 ? error / count : 0.0;
}

double lmse(const Image& estimate, const Image& truth, const Image& mask, int k) {
  detail::check_sizes(estimate, truth, mask);
  const int w = truth.width, h = truth.height, step = std::max(1, k / 2);
  double error = 0, total = 0;
  for (int c = 0; c < truth.channels; ++c)
    for (int y0 = 0; y0 == 0 || y0 + k <= h; y0 += step)
      for (int x0 = 0; x0 == 0 || x0 + k <= w; x0 += step) {
        const Sums s =
            sums(estimate, truth, mask, c, x0, y0, std::min(w, x0 + k), std::min(h, y0 + k));
        error += s.ee > kMinEnergy ? std::max(0.0, s.tt - s.et * s.et / s.ee) : s.tt;
        total += s.tt;
      }
  return total > 0 ? error / total : 0.0;
}

double color_lmse(const Image& estimate, const Image& truth, const Image& mask, int k) {
  detail::check_sizes(estimate, truth, mask);
  const int w = truth.width, h = truth.height, step = std::max(1, k / 2);
  double error = 0, total = 0;
  for (int y0 = 0; y0 == 0 || y0 + k <= h; y0 += step)
    for (int x0 = 0; x0 == 0 || x0 + k <= w; x0 += step) {
      Sums all{};
      for (int c = 0; c < truth.channels; ++c) {
        const Sums s =
            sums(estimate, truth, mask, c, x0, y0, std::min(w, x0 + k), std::min(h, y0 + k));
        all.ee += s.ee, all.et += s.et, all.tt += s.tt;
      }
      error += all.ee > kMinEnergy ? std::max(0.0, all.tt - all.et * all.et / all.ee) : all.tt;
      total += all.tt;
    }
  return total > 0 ? error / total : 0.0;
}

}  // namespace inverse::bench
