// SPDX-License-Identifier: LGPL-2.1-or-later
// Reflection of distant light by a surface (thesis Eq. 6.1-6.3), by brute force.
#pragma once

#include <vector>

#include "tests/reference/plane.hpp"

namespace inverse::reference {

/// A latitude-longitude map whose pixels are patches of constant radiance. Row 0 is up (+y), the
/// center column +z towards the viewer, x right.
struct LightMap {
  int rows = 0;  ///< columns are twice as many
  std::vector<Vec3> radiance;

  const Vec3& at(int column, int row) const {
    return radiance[static_cast<std::size_t>(row) * static_cast<std::size_t>(2 * rows) +
                    static_cast<std::size_t>(column)];
  }
};

/// D(n) = 1/pi ∫_{w·n>0} (w·n) E dw and S(n) = 1/pi ∫_{w·n>0} (h·n)^s E dw with h halfway between w
/// and v = +z; each pixel is summed over `split` x `split` points. `turn`: of the map about y,
/// radian.
struct Shading {
  Vec3 diffuse{}, specular{};
};
Shading shade(const LightMap& map, const Vec3& normal, double shininess, double turn = 0,
              int split = 2);

/// Lookup of a unit normal n that faces the viewer in a table: the hemisphere is mapped to the unit
/// disc by Lambert's equal-area projection, p = n.xy / sqrt(1 + n.z), and the disc to the square
/// table, y up; bilinear between its points.
Vec3 lit_lookup(const Plane& table, const Vec3& normal);

}  // namespace inverse::reference
