#include "lit_sphere.hpp"

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

}  // namespace inverse::reference
