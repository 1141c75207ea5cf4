// SPDX-License-Identifier: LGPL-2.1-or-later
// Two histograms over the cells of a frame: of ln max_c R, and behind it of ln S of the brightest cells, before the output's scale. Dark
// cells do not count: their light says more of the sensor than of the surface.
#include "solve/darkest.glsl"
const uint kBrightnessBins = 512u;
const float kBrightnessReach = 8.0;  // logarithms from -8 to 8

// Of a cell in the second one, by how much brighter than white in the guide it is, ln.
const float kWhiteUnit = 256.0, kWhiteSteep = 8.0;
uint white_weight(float brighter) { return uint(kWhiteUnit * min(exp(kWhiteSteep * brighter), 1.0) + 0.5); }

uint brightness_bin(float log_value) {
  return uint(clamp((log_value + kBrightnessReach) * (float(kBrightnessBins) / (2.0 * kBrightnessReach)), 0.0,
                    float(kBrightnessBins - 1u)));
}
float brightness_of(uint bin) { return (float(bin) + 0.5) * (2.0 * kBrightnessReach / float(kBrightnessBins)) - kBrightnessReach; }
