// SPDX-License-Identifier: LGPL-2.1-or-later
// Two normally distributed numbers from two words (Box and Muller 1958).
vec2 normal_pair(uvec2 words) {
  vec2 u = (vec2(words >> 8u) + 0.5) / 16777216.0;
  float angle = 6.28318530717959 * u.y;
  return sqrt(-2.0 * log(u.x)) * vec2(cos(angle), sin(angle));
}
