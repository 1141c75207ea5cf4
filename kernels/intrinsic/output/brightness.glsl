// SPDX-License-Identifier: LGPL-2.1-or-later
// Two histograms over the cells of a frame: of ln max_c R, and behind it of ln S before the output's scale. Dark cells do not count:
// their light says more of the sensor than of the surface.
#include "solve/darkest.glsl"
const uint kBrightnessBins = 512u;
const float kBrightnessReach = 8.0;  // logarithms from -8 to 8

uint brightness_bin(float log_value) {
  return uint(clamp((log_value + kBrightnessReach) * (float(kBrightnessBins) / (2.0 * kBrightnessReach)), 0.0,
                    float(kBrightnessBins - 1u)));
}
float brightness_of(uint bin) { return (float(bin) + 0.5) * (2.0 * kBrightnessReach / float(kBrightnessBins)) - kBrightnessReach; }
