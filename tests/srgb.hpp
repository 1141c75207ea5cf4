// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cmath>
#include <concepts>

namespace inverse {

/// sRGB's curve (IEC 61966-2-1) as tests, references and benchmarks have it: the code 0…1 of linear
/// light, and back. Light beyond 1 continues along the curve.
template <std::floating_point T>
T srgb_code(T light) {
  return light <= T(0.0031308) ? T(12.92) * light
                               : T(1.055) * std::pow(light, 1 / T(2.4)) - T(0.055);
}
template <std::floating_point T>
T srgb_light(T code) {
  return code <= T(0.04045) ? code / T(12.92) : std::pow((code + T(0.055)) / T(1.055), T(2.4));
}

}  // namespace inverse
