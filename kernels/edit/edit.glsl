// SPDX-License-Identifier: LGPL-2.1-or-later
// Shared by the editing kernels.
#include "image/finite.glsl"
#include "palette/max_clusters.glsl"

const uint kRows = 4u;         // pixels an invocation, one above the other
const uint kSampleSide = 64u;  // a sample of a frame is at most this wide and high
const int kMaxBases = 16;
const float kMiddleGray = 0.21404;  // sRGB code 128

// Linear light, 1 = full scale, below which chromaticity is noise: about two codes of 8-bit video. Colors fade to gray
// there.
const float kLightFloor = 5e-4;

float mean3(vec3 v) { return (v.r + v.g + v.b) * (1.0 / 3.0); }

// From 1 to 0 as t goes from 0 to 1.
float falling(float t) {
  t = clamp(t, 0.0, 1.0);
  return 1.0 - t * t * (3.0 - 2.0 * t);
}
