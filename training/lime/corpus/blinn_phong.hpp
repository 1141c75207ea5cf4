// SPDX-License-Identifier: LGPL-2.1-or-later
// The shading integrals of Blinn-Phong (thesis Eq. 6.2 and 6.3) over an environment map, as sums
// over its texels.
#pragma once

#include <cstdint>
#include <vector>

#include "environment.hpp"

namespace inverse::lime {

/// Sixteen floats for the compiler's vector instructions (GCC and Clang).
using Lanes = float __attribute__((vector_size(64)));

/// The texels of a map as directional lights, in tiles of 4 × 8 texels with a bounding cone each.
class Lights {
 public:
  explicit Lights(const Environment& map);

  /// D = Σ_{w·n > 0} (w·n) E(w) dw for a unit normal.
  Vec diffuse(Vec normal) const;

  /// S = Σ_{w·n > 0} (h·n)^s E(w) dw, h between w and `view` (unit, toward the camera). Tiles
  /// where (h·n)^s < 1e-4 are left out, unless `all`: the angle of w to the reflected view is at
  /// most twice that of h to n.
  Vec specular(Vec normal, Vec view, float shininess, bool all = false) const;

 private:
  /// Two vectors of sixteen texels; radiance is multiplied by the solid angle.
  struct Tile {
    Lanes x[2], y[2], z[2], red[2], green[2], blue[2];
    Vec axis;
    float cosine, sine;  ///< Of the cone's half angle.
  };
  std::vector<Tile> tiles_;
};

}  // namespace inverse::lime
