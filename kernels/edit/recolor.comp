// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "recolor.glsl"

// Recolors pixels with the key's chromaticity c = R / mean R and, within the value tolerance, its value. Chromaticity is weighted
// with light, c = (R S + ε) / (mean R S + ε), so that the noise of deep shadows does not count as color.
float within(float distance, float tolerance) { return falling((distance - tolerance) * push.fall_off); }

void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y * kRows);
  if (at.x >= push.size.x) return;
  uint last = min(at.y + kRows, push.size.y);
  for (uint y = at.y; y < last; ++y) {
    uint n = y * push.size.x + at.x;
    vec4 layers = finite(FETCH(intrinsic, int(n)));
    vec3 light = layers.rgb * layers.w + kLightFloor;
    vec3 off = light / mean3(light) - push.key.rgb;
    float value = abs(log((mean3(layers.rgb) + kValueFloor) / push.key.w));
    float selection = within(sqrt(dot(off, off)), push.tolerance) * within(value, push.value_tolerance);
    recolor(n, layers, selection, push.key.w);
  }
}
