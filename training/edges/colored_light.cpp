// SPDX-License-Identifier: LGPL-2.1-or-later
#include "colored_light.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/reference/intrinsic/intrinsic_features.hpp"

namespace inverse::training {
namespace {

constexpr std::array<double, 3> kAxis{0.5, 0, -0.5};  // d
constexpr double kShadingFloor = 1e-4, kMaxSlope = 1.5;
constexpr double kEvenLight = 0.02;  // variance of log shading that halves the slope
constexpr double kBright = 0.95;     // this quantile of brightness keeps its color

using Logs = std::array<double, 3>;

Logs logs(const bench::Image& image, std::size_t i, double floor) {
  Logs l{};
  for (std::size_t c = 0; c < 3; ++c) l[c] = std::log(image.data[3 * i + c] + floor);
  return l;
}
double mean(const Logs& l) { return (l[0] + l[1] + l[2]) / 3; }

}  // namespace

double light_slope(const Scene& scene) {
  double n = 1e-9, x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < scene.mask.data.size(); ++i) {
    if (scene.mask.data[i] < 0.5F) continue;
    const Logs e = logs(scene.shading, i, kShadingFloor);
    const double s = mean(e), b = e[0] - e[2];
    n += 1, x += s, y += b, xx += s * s, xy += s * b;
  }
  const double variance = xx / n - x * x / (n * n), covariance = xy / n - x * y / (n * n);
  return std::clamp(covariance / (variance + kEvenLight), -kMaxSlope, kMaxSlope);
}

Scene without_light_color(const Scene& scene, double k) {
  Scene out = scene;
  out.shading = bench::Image(scene.input.width, scene.input.height, 1);
  std::vector<double> m(scene.mask.data.size()), inside;
  for (std::size_t i = 0; i < m.size(); ++i) {
    m[i] = mean(logs(scene.input, i, reference::kIntensityFloor));
    if (scene.mask.data[i] >= 0.5F) inside.push_back(m[i]);
  }
  if (inside.empty()) inside = m;
  const auto bright = inside.begin() + std::ptrdiff_t(double(inside.size() - 1) * kBright);
  std::nth_element(inside.begin(), bright, inside.end());
  for (std::size_t i = 0; i < m.size(); ++i) {
    const Logs e = logs(scene.shading, i, kShadingFloor);
    const double s = mean(e);
    out.shading.data[i] = float(std::exp(s));
    for (std::size_t c = 0; c < 3; ++c) {
      const double light = k * kAxis[c] * (m[i] - *bright);
      out.input.data[3 * i + c] *= float(std::exp(-light));
      out.reflectance.data[3 * i + c] *= float(std::exp(e[c] - s - light));
    }
  }
  return out;
}

}  // namespace inverse::training
