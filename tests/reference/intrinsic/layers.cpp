// SPDX-License-Identifier: LGPL-2.1-or-later
#include "layers.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {
namespace {

double sanitized(double v) { return std::isinf(v) && v > 0 ? 1 : v > 0 ? std::min(v, 1e4) : 0; }

double mean_log(const Vec4& rgb) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) sum += std::log(sanitized(rgb[c]) + 2e-3);
  return sum / 3;
}

double log_shading(const Vec4& layers) { return std::log(std::max(layers[3], 1e-20)); }

}  // namespace

Vec4 layers_of(const Vec4& rgb, double log_shading, const LightColor& light) {
  const double shading = std::exp(log_shading);
  const auto color = light_color(light, log_shading - light.white);
  Vec4 layers{0, 0, 0, shading};
  for (std::size_t c = 0; c < 3; ++c) layers[c] = sanitized(rgb[c]) / color[c] / shading;
  return layers;
}

Fade fade_from(const Vec4& rgb, const Vec4& shown, const Vec4& now) {
  return {log_shading(shown) - log_shading(now), mean_log(rgb)};
}

Vec4 faded(const Fade& fade, double share, const Vec4& rgb, const Vec4& now,
           const LightColor& light) {
  const double change = (mean_log(rgb) - fade.mean) / 0.2;
  return layers_of(rgb, log_shading(now) + share * fade.difference / (1 + change * change), light);
}

}  // namespace inverse::reference
