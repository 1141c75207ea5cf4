// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
// Output layers (R, S) of intrinsicdecomp, one pixel at a time.
#include "tests/reference/image/light_color.hpp"
#include "tests/reference/plane.hpp"

namespace inverse::reference {

/// Layers of a pixel: S = e^log_shading, R = I / S, divided by the color of light. Input that is
/// NaN or negative counts as 0, +Inf as 1, and more than 1e4 as that.
Vec4 layers_of(const Vec4& rgb, double log_shading, const LightColor& light = {});

/// What fades from one solution to another, saved at a pixel of the frame that changes.
struct Fade {
  double difference;  ///< of log shading
  double mean;        ///< mean ln(I + 0.002) of the channels
};
/// `shown` and `now`: layers of the old and the new solution.
Fade fade_from(const Vec4& rgb, const Vec4& shown, const Vec4& now);
/// Layers of a later frame: `share` of the difference is added to the log shading of `now`; half of
/// that where the mean has changed by 0.2.
Vec4 faded(const Fade& fade, double share, const Vec4& rgb, const Vec4& now,
           const LightColor& light = {});

}  // namespace inverse::reference
