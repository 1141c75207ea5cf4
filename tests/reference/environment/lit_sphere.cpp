// SPDX-License-Identifier: LGPL-2.1-or-later
#include "lit_sphere.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace inverse::reference {

Shading shade(const LightMap& map, const Vec3& normal, double shininess, double turn, int split) {
  constexpr double kPi = std::numbers::pi;
  Shading result;
  const int rows = map.rows * split, columns = 2 * rows;
  for (int row = 0; row < rows; ++row) {
    const double polar = kPi * (row + 0.5) / rows;
    const double area =
        2 * kPi / columns * (std::cos(kPi * row / rows) - std::cos(kPi * (row + 1) / rows));
    for (int column = 0; column < columns; ++column) {
      const Vec3& radiance = map.at(column / split, row / split);
      if (radiance == Vec3{}) continue;
      const double azimuth = 2 * kPi * ((column + 0.5) / columns - 0.5) + turn;
      const Vec3 w{std::sin(polar) * std::sin(azimuth), std::cos(polar),
                   std::sin(polar) * std::cos(azimuth)};
      const double facing = w[0] * normal[0] + w[1] * normal[1] + w[2] * normal[2];
      if (facing <= 0) continue;
      Vec3 h{w[0], w[1], w[2] + 1};
      const double length = std::sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
      const double half =
          length > 0 ? (h[0] * normal[0] + h[1] * normal[1] + h[2] * normal[2]) / length : 0;
      const double lobe = half > 0 ? std::pow(half, shininess) : 0;
      for (std::size_t c = 0; c < 3; ++c) {
        result.diffuse[c] += area * radiance[c] * facing / kPi;
        result.specular[c] += area * radiance[c] * lobe / kPi;
      }
    }
  }
  return result;
}

Vec3 lit_lookup(const Plane& table, const Vec3& normal) {
  const double scale = 1 / std::sqrt(1 + normal[2]), last = table.width - 1.0;
  const double x = std::clamp((1 + scale * normal[0]) / 2 * table.width - 0.5, 0.0, last);
  const double y = std::clamp((1 - scale * normal[1]) / 2 * table.width - 0.5, 0.0, last);
  const int x0 = std::min(static_cast<int>(x), table.width - 2);
  const int y0 = std::min(static_cast<int>(y), table.width - 2);
  Vec3 out{};
  for (std::size_t c = 0; c < 3; ++c)
    out[c] =
        std::lerp(std::lerp(table.at(x0, y0)[c], table.at(x0 + 1, y0)[c], x - x0),
                  std::lerp(table.at(x0, y0 + 1)[c], table.at(x0 + 1, y0 + 1)[c], x - x0), y - y0);
  return out;
}

}  // namespace inverse::reference
