// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
// Guided upsampling of log shading (He and Sun, Fast Guided Filter, 2015), as
// kernels/intrinsic/resolution/upsample.glsl does it.
#include <vector>

namespace inverse::reference {

/// `rgb`: width × height pixels of three channels, linear; `half_log_shading`: of the frame at half
/// its size, rounded up. Returns log shading of every pixel: 3 × 3 half-size pixels are fitted with
/// s = a m + b, 0 <= a <= 1, m being mean ln(I + 0.002) over a half-size pixel's 2 × 2; lines are
/// averaged over 3 × 3 and interpolated bilinearly, indices clamped, and read at the pixel's own m.
std::vector<double> guided_upsample(const std::vector<double>& rgb, int width, int height,
                                    const std::vector<double>& half_log_shading);

}  // namespace inverse::reference
