#include "tests/bench/layer_metrics.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::bench {
namespace {

/// The factor that brings `estimate` nearest to `truth`.
double factor(const Image& estimate, const Image& truth) {
  double et = 0, ee = 1e-12;
  for (std::size_t i = 0; i < truth.data.size(); ++i) {
    et += double(estimate.data[i]) * truth.data[i];
    ee += double(estimate.data[i]) * estimate.data[i];
  }
  return et / ee;
}

double relative_error(const Image& estimate, const Image& truth, double scale) {
  double error = 0, all = 1e-12;
  for (std::size_t i = 0; i < truth.data.size(); ++i) {
    const double d = scale * estimate.data[i] - truth.data[i];
    error += d * d;
    all += double(truth.data[i]) * truth.data[i];
  }
  return error / all;
}

}  // namespace

Image total_light(const LightLayers& layers) {
  Image out = layers.indirect;
  for (std::size_t i = 0; i < layers.direct.data.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) out.data[3 * i + c] += layers.direct.data[i];
  return out;
}

double indirect_error(const LightLayers& estimate, const LightLayers& truth) {
  return relative_error(estimate.indirect, truth.indirect,
                        factor(estimate.indirect, truth.indirect));
}

double indirect_error_jointly(const LightLayers& estimate, const LightLayers& truth) {
  return relative_error(estimate.indirect, truth.indirect,
                        factor(total_light(estimate), total_light(truth)));
}

double direct_error_jointly(const LightLayers& estimate, const LightLayers& truth) {
  return relative_error(estimate.direct, truth.direct,
                        factor(total_light(estimate), total_light(truth)));
}

double tint_error(const LightLayers& estimate, const LightLayers& truth) {
  const Image a = total_light(estimate), b = total_light(truth);
  double sum = 0;
  const std::size_t n = a.data.size() / 3;
  for (std::size_t i = 0; i < n; ++i) {
    double d[3], middle = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      d[c] = std::log(a.data[3 * i + c] + 3e-3) - std::log(b.data[3 * i + c] + 3e-3);
      middle += d[c] / 3;
    }
    for (const double v : d) sum += (v - middle) * (v - middle);
  }
  return std::sqrt(sum / double(n));
}

double color_lmse(const Image& estimate, const Image& truth, int k) {
  const int w = truth.width, h = truth.height, step = std::max(1, k / 2);
  double error = 0, total = 0;
  for (int y0 = 0; y0 == 0 || y0 + k <= h; y0 += step)
    for (int x0 = 0; x0 == 0 || x0 + k <= w; x0 += step) {
      double ee = 1e-12, et = 0, tt = 0;
      for (int y = y0; y < std::min(h, y0 + k); ++y)
        for (int x = x0; x < std::min(w, x0 + k); ++x)
          for (int c = 0; c < truth.channels; ++c) {
            const double e = estimate.at(x, y, c), t = truth.at(x, y, c);
            ee += e * e, et += e * t, tt += t * t;
          }
      error += std::max(0.0, tt - et * et / ee);
      total += tt;
    }
  return total > 0 ? error / total : 0.0;
}

double color_mse(const Image& estimate, const Image& truth) {
  const double scale = factor(estimate, truth);
  const double peak = std::max(1e-9F, *std::max_element(truth.data.begin(), truth.data.end()));
  double sum = 0;
  for (std::size_t i = 0; i < truth.data.size(); ++i) {
    const double d = (scale * estimate.data[i] - truth.data[i]) / peak;
    sum += d * d;
  }
  return sum / double(truth.data.size());
}

}  // namespace inverse::bench
