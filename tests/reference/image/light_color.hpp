// SPDX-License-Identifier: LGPL-2.1-or-later
// The color of light in double precision: the specification of kernels/image/light_color.glsl.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace inverse::reference {

/// Ln light of channel c is (1 + slope d_c) s, s the log shading, d = (½, 0, −½) for R, G, B. One
/// slope a scene; 0 is gray light.
struct LightColor {
  double slope = 0;
  double reference = 0;  ///< Mean log intensity m at which the guide takes light as white.
  double white = 0;      ///< Log shading at which light is white.
};

/// Factors of the channels R, G, B from white light to light that is `above` brighter, ln.
inline std::array<double, 3> light_color(const LightColor& light, double above) {
  const double red = std::exp(std::clamp(light.slope * above / 2, -20.0, 20.0));
  return {red, 1, 1 / red};
}

/// A pixel (R.rgb, S) as gray light of the same shading would need it to look the same: R times the
/// color of light, S.
inline std::array<double, 4> in_gray_light(const std::array<double, 4>& layers,
                                           const LightColor& light) {
  const auto color = light_color(light, std::log(std::max(layers[3], 1e-30)) - light.white);
  return {layers[0] * color[0], layers[1] * color[1], layers[2] * color[2], layers[3]};
}

}  // namespace inverse::reference
