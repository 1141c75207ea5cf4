// SPDX-License-Identifier: LGPL-2.1-or-later
// Log intensity of a frame, by which strokes are followed, and its means over 2 x 2, 4 x 4, … pixels: levels 1 to kLevels - 1, one
// after the other (at an odd border the last row or column counts twice).
#include "image/finite.glsl"
const int kLevels = 6;
const float kLightFloor = 0.02;  // linear light: the dark is noise

float log_light(vec4 rgb) {
  vec4 light = finite(rgb);
  return log((light.r + light.g + light.b) / 3.0 + kLightFloor);
}
