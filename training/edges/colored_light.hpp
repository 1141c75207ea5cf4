// SPDX-License-Identifier: LGPL-2.1-or-later
// Light whose color follows its brightness along the blue-yellow axis: the logarithm of channel c
// is (1 + k d_c) s, with one slope k a scene.
#pragma once

#include "scenes.hpp"

namespace inverse::training {

/// Rms error of an estimated slope on scenes that its fit has not seen (training/intrinsic).
inline constexpr double kSlopeError = 0.2;

/// The least-squares slope of a scene's irradiance.
double light_slope(const Scene& scene);

/// Corrects picture and truth by slope k, which leaves gray light where the slope is right.
/// Shading becomes one channel, the mean logarithm; what color light keeps goes into reflectance.
Scene without_light_color(const Scene& scene, double k);

}  // namespace inverse::training
