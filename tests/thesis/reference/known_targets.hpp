// SPDX-License-Identifier: LGPL-2.1-or-later
// What is known of a frame's reflectance, as the stabilization of the thesis takes it (4.8).
#pragma once
#include "intrinsic_thesis_energy.hpp"
#include "tests/reference/intrinsic/recall.hpp"

namespace inverse::reference {

/// rgb = B r_model, w = B of every pixel of `image` (sanitized linear light). r_model = ln R − ln
/// c, of the nearest point. B is 0 where nothing is known, and where the depths differ by more than
/// 2 cm and four standard deviations of a structured-light sensor; else 1 / (1 + (d / .4)²), d the
/// distance of two colors, the pixel's and the known one at its brightness:
///   d² = ¾ (k_R − k_G)² + (½ (k_R + k_G) − k_B)²,  k = ln((I + ε_c) / (I' + ε_c)).
Plane known_targets(const Plane& image, const KnownReflectance& known, double log_scale,
                    const ThesisParams& params);

}  // namespace inverse::reference
