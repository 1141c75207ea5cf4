// SPDX-License-Identifier: LGPL-2.1-or-later
// Input and output of a scene's palette in double precision. The specification of pick.comp and
// paint.comp in kernels/palette.
#pragma once

#include <vector>

#include "tests/reference/plane.hpp"

namespace inverse::reference {

inline constexpr double kReflectanceFloor = 1e-3;  ///< Lower bound of R before the logarithm.

/// ln R of every stride-th pixel of every stride-th row; `model` is (R.rgb, S). NaN and negative
/// values become 0, infinity 65504.
Plane pick(const Plane& model, int stride);

/// Every pixel in the color nearest to it in ln R, linear, w = 1. `log_colors` not empty.
Plane paint(const Plane& model, const std::vector<Vec3>& log_colors);

}  // namespace inverse::reference
