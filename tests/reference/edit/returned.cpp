// SPDX-License-Identifier: LGPL-2.1-or-later
#include "returned.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {
namespace {

constexpr double kLargest = 65504;
constexpr double kTiny = 1e-20;  // light below has no color

double mean(const Rgb& v) { return (v[0] + v[1] + v[2]) / 3; }

Rgb color_of(const Rgba& pixel, const std::array<double, 9>& gamut) {
  const Rgba p = finite(pixel);
  Rgb converted{};
  for (size_t row = 0; row < 3; ++row)
    converted[row] =
        finite(gamut[3 * row] * p[0] + gamut[3 * row + 1] * p[1] + gamut[3 * row + 2] * p[2]);
  return converted;
}

}  // namespace

double change(double v, double p, double q, double gain) {
  return p < q ? v * p / q - v : (p - q) / gain;
}

Rgb change_at(const Rgb& v, const ReturnedPicture& picture, size_t x, size_t y, size_t width,
              size_t height) {
  const auto place = [](size_t at, size_t from, size_t to) {
    return (static_cast<double>(at) + 0.5) * static_cast<double>(from) / static_cast<double>(to) -
           0.5;
  };
  const double px = place(x, picture.width, width), py = place(y, picture.height, height);
  Rgb sum{};
  for (int dy = 0; dy < 2; ++dy)
    for (int dx = 0; dx < 2; ++dx) {
      const double tx = px - std::floor(px), ty = py - std::floor(py);
      const double weight = (dx ? tx : 1 - tx) * (dy ? ty : 1 - ty);
      const auto inside = [](double at, size_t size) {
        return static_cast<size_t>(std::clamp(at, 0.0, static_cast<double>(size - 1)));
      };
      const size_t n = inside(std::floor(py) + dy, picture.height) * picture.width +
                       inside(std::floor(px) + dx, picture.width);
      const Rgb p = color_of(picture.returned[n], picture.gamut),
                q = color_of(picture.sent[n], picture.gamut);
      for (size_t c = 0; c < 3; ++c) sum[c] += weight * change(v[c], p[c], q[c], picture.gain);
    }
  return sum;
}

Rgba edited_reflectance(const Rgba& layers, const Rgb& change, double weight) {
  Rgba edited = layers;
  for (size_t c = 0; c < 3; ++c)
    edited[c] = std::clamp(layers[c] + weight * change[c], 0.0, kLargest);
  return edited;
}

Rgba edited_mask(const Rgba& mask, const Rgb& change, double weight) {
  Rgba edited = mask;
  edited[0] = std::clamp(mask[0] + weight * mean(change), 0.0, 1.0);
  return edited;
}

Rgb Light::unit() const {
  if (!own) return {shading, shading, shading};
  if (shading <= 0) return {};
  const auto color_of_light = light_color(*own, std::log(shading) - own->white);
  return {shading * color_of_light[0], shading * color_of_light[1], shading * color_of_light[2]};
}

Rgb Light::total() const {
  const Rgb u = unit();
  return {u[0] * color[0], u[1] * color[1], u[2] * color[2]};
}

Rgb Light::direct() const {
  const Rgb u = unit();
  return {u[0] * color[3] * lamp[0], u[1] * color[3] * lamp[1], u[2] * color[3] * lamp[2]};
}

Rgb Light::indirect() const {
  const Rgb all = total(), d = direct();
  return {std::max(all[0] - d[0], 0.0), std::max(all[1] - d[1], 0.0), std::max(all[2] - d[2], 0.0)};
}

Light edited_light(const Light& light, LightPart part, const Rgb& change, double weight,
                   bool tint) {
  if (weight == 0 || change == Rgb{}) return light;
  Light edited = light;
  const Rgb before = light.total(), direct = light.direct();
  Rgb now{}, direct_now{};
  for (size_t c = 0; c < 3; ++c) {
    now[c] = std::clamp(before[c] + weight * change[c], 0.0, kLargest);
    direct_now[c] = direct[c] + weight * change[c];
  }
  if (part == LightPart::all || light.shading == 0)
    edited.shading = std::min(
        mean(before) > kTiny ? light.shading * mean(now) / mean(before) : mean(now), kLargest);
  if (!tint) return edited;
  const Rgb unit = edited.unit();
  for (size_t c = 0; c < 3; ++c)
    if (unit[c] > 0) edited.color[c] = std::min(now[c] / unit[c], kLargest);
  const double reach =
      mean({unit[0] * light.lamp[0], unit[1] * light.lamp[1], unit[2] * light.lamp[2]});
  if (part == LightPart::direct && reach > 0)
    edited.color[3] = std::clamp(mean(direct_now) / reach, 0.0, kLargest);
  return edited;
}

}  // namespace inverse::reference
