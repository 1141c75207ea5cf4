// SPDX-License-Identifier: LGPL-2.1-or-later
// Environment maps: equirectangular, row 0 = +y (up), center column = +z (toward the camera), x
// right.
#pragma once

#include <vector>

#include "vec.hpp"

namespace inverse::lime {

/// Direction of a texel's center.
Vec texel_direction(int row, int column, int rows, int columns);
/// Solid angle of a texel, sr.
float texel_solid_angle(int row, int rows, int columns);

/// Linear radiance of any scale, rows × 2 rows.
struct Environment {
  static constexpr int kRows = 96,
                       kColumns = 192;  ///< Of all maps that samples are rendered under.
  int rows = kRows;
  std::vector<Vec> radiance;

  int columns() const { return 2 * rows; }
  Vec& at(int row, int column) { return radiance[std::size_t(row * columns() + column)]; }
  const Vec& at(int row, int column) const {
    return radiance[std::size_t(row * columns() + column)];
  }
  /// Bilinear lookup; what a mirror shows that reflects into `direction` (unit length).
  Vec look(Vec direction) const;
};

/// Solid-angle-weighted mean of blocks of texels; `rows` divides the map's.
Environment shrink(const Environment& map, int rows);

/// The map turned about y by whole columns, and mirrored left to right on request.
Environment turn(const Environment& map, int columns, bool mirrored);

/// Whether a strong light is in the frontal hemisphere, where its highlights are visible: the
/// brightest frontal block of 4 × 4 texels reaches 60 % of the brightest of all.
bool is_lit_from_front(const Environment& map);

/// Scales channels toward equal mean radiance, as a camera's white balance does; strength 0 … 1.
void balance_white(Environment& map, float strength);

}  // namespace inverse::lime
