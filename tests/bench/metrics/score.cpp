// SPDX-License-Identifier: LGPL-2.1-or-later
#include <algorithm>
#include <cmath>

#include "detail.hpp"
#include "metrics.hpp"

namespace inverse::bench {

Scores score(const Image& reflectance, const Image& shading, const Image& true_reflectance,
             const Image& true_shading, const Image& mask) {
  constexpr int kPairs = 2000;
  Scores s;
  const auto add = [&](const Image& estimate, const Image& truth) {
    double peak = 1;
    const Image e = fitted(estimate, truth, mask, &peak);
    Image t = truth;
    for (float& v : t.data) v = float(v / peak);
    s.lmse20 += lmse(estimate, truth, mask, 20) / 2;
    s.lmse10 += lmse(estimate, truth, mask, 10) / 2;
    s.mse += mse(e, t, mask) / 2;
    s.psnr += psnr(e, t, mask) / 2;
    s.dssim += (1 - ssim(e, t, mask)) / 4;
    s.ms_ssim += ms_ssim(e, t, mask) / 2;
  };
  add(reflectance, true_reflectance);
  add(shading, true_shading);
  s.whdr = whdr(reflectance, judge(true_reflectance, mask, kPairs, 1));
  return s;
}

double score_lmse(const Image& reflectance, const Image& shading, const Image& true_reflectance,
                  const Image& true_shading, const Image& mask) {
  return (lmse(reflectance, true_reflectance, mask, 20) + lmse(shading, true_shading, mask, 20)) /
         2;
}

double log_distance(const Image& reflectance, const Image& other, const Image& mask) {
  detail::check_sizes(reflectance, other, mask);
  const auto floored = [](float v) { return std::log(std::max(double(v), detail::kLogFloor)); };
  double sum = 0, squares = 0, count = 0;
  for (int y = 0; y < other.height; ++y)
    for (int x = 0; x < other.width; ++x)
      for (int c = 0; detail::counts(mask, x, y) && c < other.channels; ++c) {
        const double d = floored(reflectance.at(x, y, c)) - floored(other.at(x, y, c));
        sum += d, squares += d * d, count += 1;
      }
  return count > 0 ? std::sqrt(std::max(0.0, squares / count - sum * sum / (count * count))) : 0.0;
}

}  // namespace inverse::bench
