// What a scene's palette looks at and what it shows, in double precision. This is the specification
// of pick.comp and paint.comp in kernels/palette.
#pragma once

#include <vector>

#include "tests/reference/plane.hpp"

namespace inverse::reference {

inline constexpr double kReflectanceFloor = 1e-3;  ///< What ln R is taken of at least.

/// ln R of every stride-th pixel of every stride-th row; `model` is (R.rgb, S). Not-a-numbers and
/// negatives count as 0, infinity as 65504.
Plane pick(const Plane& model, int stride);

/// Every pixel in the color nearest to it in ln R, linear, w = 1. `log_colors` not empty.
Plane paint(const Plane& model, const std::vector<Vec3>& log_colors);

}  // namespace inverse::reference
