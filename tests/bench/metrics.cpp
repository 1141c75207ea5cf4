#include "tests/bench/metrics.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace inverse::bench {
namespace {

constexpr double kLeastEnergy = 1e-12;
constexpr double kLogFloor = 1e-4;

double mask_at(const Image& mask, int x, int y) {
  return mask.empty() ? 1.0 : (mask.at(x, y) > 0.5F ? 1.0 : 0.0);
}

/// Least-squares factor of one channel and the largest true value inside the mask.
struct Fit {
  double scale = 0;
  double peak = 0;
};

Fit fit_channel(const Image& estimate, const Image& truth, const Image& mask, int c) {
  double ee = 0, et = 0, peak = 0;
  for (int y = 0; y < truth.height; ++y)
    for (int x = 0; x < truth.width; ++x) {
      if (mask_at(mask, x, y) == 0) continue;
      const double e = estimate.at(x, y, c), t = truth.at(x, y, c);
      ee += e * e;
      et += e * t;
      peak = std::max(peak, t);
    }
  return {ee > kLeastEnergy ? et / ee : 0.0, peak};
}

double peak_of(const Image& truth, const Image& mask) {
  double peak = 0;
  for (int y = 0; y < truth.height; ++y)
    for (int x = 0; x < truth.width; ++x)
      if (mask_at(mask, x, y) > 0)
        for (int c = 0; c < truth.channels; ++c) peak = std::max<double>(peak, truth.at(x, y, c));
  return std::max(peak, 1e-9);
}

/// Separable Gaussian blur, zero outside.
std::vector<double> blur(const std::vector<double>& in, int w, int h) {
  constexpr int kRadius = 5;
  constexpr double kSigma = 1.5;
  std::array<double, 2 * kRadius + 1> g{};
  double sum = 0;
  for (int k = -kRadius; k <= kRadius; ++k)
    sum += g[k + kRadius] = std::exp(-0.5 * k * k / (kSigma * kSigma));
  for (double& v : g) v /= sum;
  std::vector<double> mid(in.size()), out(in.size());
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      double v = 0;
      for (int k = -kRadius; k <= kRadius; ++k)
        if (x + k >= 0 && x + k < w) v += g[k + kRadius] * in[std::size_t(y) * w + x + k];
      mid[std::size_t(y) * w + x] = v;
    }
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      double v = 0;
      for (int k = -kRadius; k <= kRadius; ++k)
        if (y + k >= 0 && y + k < h) v += g[k + kRadius] * mid[std::size_t(y + k) * w + x];
      out[std::size_t(y) * w + x] = v;
    }
  return out;
}

/// Logarithm of the mean channel, minus its mean over the pixels when `centered`.
std::vector<double> log_mean_channel(const Image& image, bool centered) {
  std::vector<double> l(image.data.size() / std::size_t(image.channels));
  double mean = 0;
  for (std::size_t i = 0; i < l.size(); ++i) {
    double v = 0;
    for (int c = 0; c < image.channels; ++c)
      v += image.data[i * std::size_t(image.channels) + std::size_t(c)];
    l[i] = std::log(std::max(v / image.channels, kLogFloor));
    mean += l[i] / double(l.size());
  }
  if (centered)
    for (double& v : l) v -= mean;
  return l;
}

}  // namespace

double lmse(const Image& estimate, const Image& truth, const Image& mask, int k) {
  const int w = truth.width, h = truth.height, step = std::max(1, k / 2);
  double error = 0, total = 0;
  for (int c = 0; c < truth.channels; ++c)
    for (int y0 = 0; y0 == 0 || y0 + k <= h; y0 += step)
      for (int x0 = 0; x0 == 0 || x0 + k <= w; x0 += step) {
        double ee = 0, et = 0, tt = 0;
        for (int y = y0; y < std::min(h, y0 + k); ++y)
          for (int x = x0; x < std::min(w, x0 + k); ++x) {
            if (mask_at(mask, x, y) == 0) continue;
            const double e = estimate.at(x, y, c), t = truth.at(x, y, c);
            ee += e * e;
            et += e * t;
            tt += t * t;
          }
        error += ee > kLeastEnergy ? std::max(0.0, tt - et * et / ee) : tt;
        total += tt;
      }
  return total > 0 ? error / total : 0.0;
}

double scale_invariant_mse(const Image& estimate, const Image& truth, const Image& mask) {
  const double peak = peak_of(truth, mask);
  double error = 0, count = 0;
  for (int c = 0; c < truth.channels; ++c) {
    const Fit fit = fit_channel(estimate, truth, mask, c);
    for (int y = 0; y < truth.height; ++y)
      for (int x = 0; x < truth.width; ++x) {
        if (mask_at(mask, x, y) == 0) continue;
        const double d = (fit.scale * estimate.at(x, y, c) - truth.at(x, y, c)) / peak;
        error += d * d;
        count += 1;
      }
  }
  return count > 0 ? error / count : 0.0;
}

double dssim(const Image& estimate, const Image& truth, const Image& mask) {
  constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03, kLeastWeight = 0.05;
  const int w = truth.width, h = truth.height;
  const std::size_t n = std::size_t(w) * h;
  const double peak = peak_of(truth, mask);
  std::vector<double> inside(n);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) inside[std::size_t(y) * w + x] = mask_at(mask, x, y);
  const std::vector<double> weight = blur(inside, w, h);
  double sum = 0, count = 0;
  for (int c = 0; c < truth.channels; ++c) {
    const double scale = fit_channel(estimate, truth, mask, c).scale;
    std::vector<double> e(n), t(n), ee(n), tt(n), et(n);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t j = i * std::size_t(truth.channels) + std::size_t(c);
      e[i] = inside[i] * scale * estimate.data[j] / peak;
      t[i] = inside[i] * truth.data[j] / peak;
      ee[i] = e[i] * e[i];
      tt[i] = t[i] * t[i];
      et[i] = e[i] * t[i];
    }
    e = blur(e, w, h), t = blur(t, w, h), ee = blur(ee, w, h), tt = blur(tt, w, h);
    et = blur(et, w, h);
    for (std::size_t i = 0; i < n; ++i) {
      if (inside[i] == 0 || weight[i] < kLeastWeight) continue;
      const double me = e[i] / weight[i], mt = t[i] / weight[i];
      const double ve = std::max(0.0, ee[i] / weight[i] - me * me);
      const double vt = std::max(0.0, tt[i] / weight[i] - mt * mt);
      const double cov = et[i] / weight[i] - me * mt;
      const double ssim =
          (2 * me * mt + kC1) * (2 * cov + kC2) / ((me * me + mt * mt + kC1) * (ve + vt + kC2));
      sum += 0.5 * (1 - ssim);
      count += 1;
    }
  }
  return count > 0 ? sum / count : 0.0;
}

Scores score(const Image& reflectance, const Image& shading, const Image& true_reflectance,
             const Image& true_shading, const Image& mask) {
  const auto both = [&](auto measure) {
    return 0.5 * (measure(reflectance, true_reflectance) + measure(shading, true_shading));
  };
  Scores s;
  s.lmse20 = both([&](const Image& e, const Image& t) { return lmse(e, t, mask, 20); });
  s.lmse10 = both([&](const Image& e, const Image& t) { return lmse(e, t, mask, 10); });
  s.mse = both([&](const Image& e, const Image& t) { return scale_invariant_mse(e, t, mask); });
  s.dssim = both([&](const Image& e, const Image& t) { return dssim(e, t, mask); });
  return s;
}

double flicker(const std::vector<Image>& reflectance, bool remove_gauge) {
  if (reflectance.size() < 2) return 0.0;
  const std::size_t n = reflectance[0].data.size() / std::size_t(reflectance[0].channels);
  std::vector<double> sum(n, 0.0), squares(n, 0.0);
  for (const Image& r : reflectance) {
    const std::vector<double> l = log_mean_channel(r, remove_gauge);
    for (std::size_t i = 0; i < n; ++i) {
      sum[i] += l[i];
      squares[i] += l[i] * l[i];
    }
  }
  const double frames = double(reflectance.size());
  double total = 0;
  for (std::size_t i = 0; i < n; ++i)
    total += std::sqrt(std::max(0.0, squares[i] / frames - sum[i] * sum[i] / (frames * frames)));
  return total / double(n);
}

double jitter(const std::vector<Image>& reflectance) {
  if (reflectance.size() < 2) return 0.0;
  std::vector<double> before = log_mean_channel(reflectance[0], true), squares(before.size(), 0.0);
  for (std::size_t k = 1; k < reflectance.size(); ++k) {
    const std::vector<double> now = log_mean_channel(reflectance[k], true);
    for (std::size_t i = 0; i < now.size(); ++i)
      squares[i] += (now[i] - before[i]) * (now[i] - before[i]);
    before = now;
  }
  double total = 0;
  for (double v : squares) total += std::sqrt(v / (2 * double(reflectance.size() - 1)));
  return total / double(squares.size());
}

}  // namespace inverse::bench
