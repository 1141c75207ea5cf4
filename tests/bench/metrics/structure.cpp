// SPDX-License-Identifier: LGPL-2.1-or-later
#include <algorithm>
#include <array>
#include <cmath>

#include "detail.hpp"
#include "metrics.hpp"

namespace inverse::bench {
namespace {

constexpr int kRadius = 5;
constexpr int kWindow = 2 * kRadius + 1;
constexpr double kSigma = 1.5;
constexpr double kMinWeight = 0.05;  // of a window inside the mask
constexpr std::array<double, 5> kExponents{0.0448, 0.2856, 0.3001, 0.2363, 0.1333};

/// One channel in double precision.
struct Channel {
  int width = 0, height = 0;
  std::vector<double> v;
  Channel(int w, int h) : width(w), height(h), v(std::size_t(w) * std::size_t(h)) {}
};

Channel channel_of(const Image& image, int c) {
  Channel out(image.width, image.height);
  for (std::size_t i = 0; i < out.v.size(); ++i)
    out.v[i] = image.data[i * std::size_t(image.channels) + std::size_t(c)];
  return out;
}

Channel inside_of(const Image& mask, int width, int height) {
  Channel out(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      out.v[std::size_t(y) * std::size_t(width) + std::size_t(x)] =
          detail::counts(mask, x, y) ? 1 : 0;
  return out;
}

const std::array<double, kWindow>& gaussian() {
  static const std::array<double, kWindow> kernel = [] {
    std::array<double, kWindow> g{};
    double sum = 0;
    for (int k = -kRadius; k <= kRadius; ++k)
      sum += g[std::size_t(k + kRadius)] = std::exp(-0.5 * k * k / (kSigma * kSigma));
    for (double& x : g) x /= sum;
    return g;
  }();
  return kernel;
}

/// Separable Gaussian, zero outside.
Channel blur(const Channel& in) {
  const int w = in.width, h = in.height;
  Channel mid(w, h), out(w, h);
  for (int k = -kRadius; k <= kRadius; ++k) {
    const double g = gaussian()[std::size_t(k + kRadius)];
    for (int y = 0; y < h; ++y) {
      const double* from = &in.v[std::size_t(y) * std::size_t(w)];
      double* to = &mid.v[std::size_t(y) * std::size_t(w)];
      for (int x = std::max(0, -k); x < w - std::max(0, k); ++x) to[x] += g * from[x + k];
    }
  }
  for (int y = 0; y < h; ++y)
    for (int k = std::max(-kRadius, -y); k <= std::min(kRadius, h - 1 - y); ++k) {
      const double g = gaussian()[std::size_t(k + kRadius)];
      const double* from = &mid.v[std::size_t(y + k) * std::size_t(w)];
      double* to = &out.v[std::size_t(y) * std::size_t(w)];
      for (int x = 0; x < w; ++x) to[x] += g * from[x];
    }
  return out;
}

Channel product(const Channel& a, const Channel& b) {
  Channel out(a.width, a.height);
  for (std::size_t i = 0; i < out.v.size(); ++i) out.v[i] = a.v[i] * b.v[i];
  return out;
}

/// 2 x 2 means; for a mask, whether all four are inside.
Channel halve(const Channel& in, bool all) {
  Channel out(in.width / 2, in.height / 2);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const double* p = &in.v[std::size_t(2 * y) * std::size_t(in.width) + std::size_t(2 * x)];
      const double mean = (p[0] + p[1] + p[in.width] + p[in.width + 1]) / 4;
      out.v[std::size_t(y) * std::size_t(out.width) + std::size_t(x)] =
          all ? (mean > 0.999 ? 1 : 0) : mean;
    }
  return out;
}

/// Means over the windows of SSIM and of its factor without luminance.
struct Similarity {
  double whole = 1, contrast = 1;
};

Similarity similarity(Channel e, Channel t, const Channel& inside, double range) {
  const double c1 = std::pow(0.01 * range, 2), c2 = std::pow(0.03 * range, 2);
  e = product(e, inside), t = product(t, inside);
  const Channel weight = blur(inside), ee = blur(product(e, e)), tt = blur(product(t, t)),
                et = blur(product(e, t));
  e = blur(e), t = blur(t);
  const int margin = std::min(e.width, e.height) >= kWindow ? kRadius : 0;
  double whole = 0, contrast = 0, count = 0;
  for (int y = margin; y < e.height - margin; ++y)
    for (int x = margin; x < e.width - margin; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(e.width) + std::size_t(x);
      const double w = weight.v[i];
      if (inside.v[i] == 0 || w < kMinWeight) continue;
      const double me = e.v[i] / w, mt = t.v[i] / w;
      const double ve = std::max(0.0, ee.v[i] / w - me * me);
      const double vt = std::max(0.0, tt.v[i] / w - mt * mt);
      const double cs = (2 * (et.v[i] / w - me * mt) + c2) / (ve + vt + c2);
      whole += cs * (2 * me * mt + c1) / (me * me + mt * mt + c1);
      contrast += cs;
      count += 1;
    }
  return count > 0 ? Similarity{whole / count, contrast / count} : Similarity{};
}

}  // namespace

double ssim(const Image& estimate, const Image& truth, const Image& mask, double range) {
  detail::check_sizes(estimate, truth, mask);
  const Channel inside = inside_of(mask, truth.width, truth.height);
  double sum = 0;
  for (int c = 0; c < truth.channels; ++c)
    sum += similarity(channel_of(estimate, c), channel_of(truth, c), inside, range).whole;
  return sum / truth.channels;
}

double dssim(const Image& estimate, const Image& truth, const Image& mask) {
  double peak = 1;
  const Image e = fitted(estimate, truth, mask, &peak);
  Image t = truth;
  for (float& v : t.data) v = float(v / peak);
  return 0.5 * (1 - ssim(e, t, mask, 1));
}

double ms_ssim(const Image& estimate, const Image& truth, const Image& mask, double range) {
  detail::check_sizes(estimate, truth, mask);
  std::size_t scales = 1;
  double exponents = kExponents[0];
  while (scales < kExponents.size() && (std::min(truth.width, truth.height) >> scales) >= kWindow)
    exponents += kExponents[scales++];
  double sum = 0;
  for (int c = 0; c < truth.channels; ++c) {
    Channel e = channel_of(estimate, c), t = channel_of(truth, c),
            inside = inside_of(mask, truth.width, truth.height);
    double value = 1;
    for (std::size_t k = 0; k < scales; ++k) {
      if (k > 0) e = halve(e, false), t = halve(t, false), inside = halve(inside, true);
      const Similarity s = similarity(e, t, inside, range);
      const double factor = k + 1 == scales ? s.whole : s.contrast;
      value *= std::pow(std::max(0.0, factor), kExponents[k] / exponents);
    }
    sum += value;
  }
  return sum / truth.channels;
}

}  // namespace inverse::bench
