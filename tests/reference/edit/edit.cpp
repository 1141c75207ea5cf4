// SPDX-License-Identifier: LGPL-2.1-or-later
#include "edit.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {
namespace {

constexpr double kLargest = 65504;
constexpr double kValueFloor = 1e-3;
constexpr double kLightFloor = 5e-4;
constexpr double kReflectanceFloor = 1e-3;
constexpr double kRatioFloor = 2e-3;
constexpr double kMiddleGray = 0.21404;

double mean(const Rgb& color) { return (color[0] + color[1] + color[2]) / 3; }
double mean(const Rgba& pixel) { return (pixel[0] + pixel[1] + pixel[2]) / 3; }

/// 1 up to the tolerance, a smooth step down to 0 over the softness after it.
double within(double distance, double tolerance, double softness) {
  const double t = std::clamp((distance - tolerance) / std::max(softness, 1e-6), 0.0, 1.0);
  return 1 - t * t * (3 - 2 * t);
}

}  // namespace

double finite(double value) { return value > 0 ? std::min(value, kLargest) : 0; }

Rgba finite(const Rgba& pixel) {
  return {finite(pixel[0]), finite(pixel[1]), finite(pixel[2]), finite(pixel[3])};
}

double selection(const Rgba& layers, const RecolorSpec& spec) {
  const Rgba p = finite(layers);
  const double light = mean(p) * p[3] + kLightFloor;
  const double key = mean(spec.key);
  double distance2 = 0;
  for (int c = 0; c < 3; ++c) {
    const double off = (p[c] * p[3] + kLightFloor) / light - (key > 0 ? spec.key[c] / key : 1);
    distance2 += off * off;
  }
  double result = within(std::sqrt(distance2), spec.tolerance, spec.softness);
  if (spec.value_tolerance < 20)
    result *= within(std::abs(std::log((mean(p) + kValueFloor) / (key + kValueFloor))),
                     spec.value_tolerance, spec.softness);
  return result;
}

double selection(const Rgba& layers, const Rgb& own, const std::vector<Rgb>& others,
                 double softness) {
  const Rgba p = finite(layers);
  const auto distance = [&](const Rgb& color) {
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
      const double off = std::log(std::max(p[c], kReflectanceFloor)) - color[c];
      sum += off * off;
    }
    return std::sqrt(sum);
  };
  double nearest = 1e15;
  for (const Rgb& other : others) nearest = std::min(nearest, distance(other));
  const double margin = (nearest - distance(own)) / std::max(softness, 1e-6);
  return within(0.5 - margin, 0, 1);
}

Rgba recolor(const Rgba& layers, double selection, double key_value, const RecolorSpec& spec,
             const Rgba& mask) {
  const Rgba p = finite(layers);
  const double matte = std::min(finite(mask[0]), 1.0);
  Rgba object = p;
  for (size_t c = 0; c < 3; ++c) {
    const double behind = std::abs(mask[c + 1]) < kLargest ? mask[c + 1] : 0;
    object[c] = finite(p[c] - (1 - matte) / std::max(matte, 0.1) * behind);
  }
  const double scale = std::pow((mean(object) + kValueFloor) / key_value, spec.texture) *
                       std::pow(key_value / (mean(spec.target) + kValueFloor), spec.brightness);
  const double angle = spec.hue_shift * std::acos(-1.0) / 180;
  Rgb target{};
  for (size_t c = 0; c < 3; ++c) target[c] = spec.own_color ? object[c] : spec.target[c] * scale;
  const double gray = mean(target);
  Rgba result = p;
  for (size_t c = 0; c < 3; ++c) {
    const double across = (target[(c + 2) % 3] - target[(c + 1) % 3]) / std::sqrt(3.0);
    const double turned = std::max(
        std::cos(angle) * target[c] + (1 - std::cos(angle)) * gray + std::sin(angle) * across, 0.0);
    result[c] = finite(p[c] + spec.strength * selection * matte * (turned - object[c]));
  }
  return result;
}

Rgba recolor(const Rgba& layers, const Rgba& mask, const RecolorSpec& spec) {
  return recolor(layers, selection(layers, spec), mean(spec.key) + kValueFloor, spec, mask);
}

Rgba compose(const Rgba& input, const Rgba& model, const Rgba& intrinsic, Residual residual,
             double strength) {
  const Rgba seen = finite(input), before = finite(model), now = finite(intrinsic);
  Rgba result{0, 0, 0, std::min(seen[3], 1.0)};
  for (int c = 0; c < 3; ++c) {
    const double from = before[c] * before[3], to = now[c] * now[3];
    double edited = to;
    if (residual == Residual::add) edited = seen[c] + (to - from);
    if (residual == Residual::ratio) edited = seen[c] * ((to + kRatioFloor) / (from + kRatioFloor));
    result[c] = finite(seen[c] + strength * (edited - seen[c]));
  }
  return result;
}

Rgba difference(const Rgba& input, const Rgba& model, const Rgba& intrinsic) {
  const Rgba before = finite(model), now = finite(intrinsic);
  Rgba result{0, 0, 0, std::min(finite(input[3]), 1.0)};
  for (int c = 0; c < 3; ++c)
    result[c] = finite(kMiddleGray + (now[c] * now[3] - before[c] * before[3]) / 2);
  return result;
}

Rgba recombine(const Rgba& input, const Rgba& diffuse, const Rgba& specular, double strength) {
  const Rgba seen = finite(input), under = finite(diffuse), over = finite(specular);
  Rgba result{0, 0, 0, std::min(seen[3], 1.0)};
  for (int c = 0; c < 3; ++c)
    result[c] = finite((1 - strength) * seen[c] + strength * (under[c] + over[c]));
  return result;
}

Rgba recombine_difference(const Rgba& input, const Rgba& diffuse, const Rgba& specular) {
  const Rgba seen = finite(input), under = finite(diffuse), over = finite(specular);
  Rgba result{0, 0, 0, std::min(seen[3], 1.0)};
  for (int c = 0; c < 3; ++c) result[c] = finite(kMiddleGray + (under[c] + over[c] - seen[c]) / 2);
  return result;
}

}  // namespace inverse::reference
