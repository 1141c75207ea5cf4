// SPDX-License-Identifier: LGPL-2.1-or-later
// The sRGB curve on linear light and code values of 0…1.
vec3 to_linear(vec3 srgb) {
  return mix(pow((max(srgb, vec3(0.0)) + 0.055) / 1.055, vec3(2.4)), srgb / 12.92, lessThanEqual(srgb, vec3(0.04045)));
}

vec3 to_srgb(vec3 linear) {
  vec3 x = clamp(linear, 0.0, 1.0);
  return mix(1.055 * pow(max(x, vec3(1e-8)), vec3(1.0 / 2.4)) - 0.055, 12.92 * x, lessThanEqual(x, vec3(0.0031308)));
}
