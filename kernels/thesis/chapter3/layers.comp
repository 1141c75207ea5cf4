// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"

// The layers in linear light, R = exp(r + ln c), S = exp(s − ln c).
PLANE_IN(0, solution);
PLANE_IN(1, scale);  // .x = ln c (scale.glsl)
PLANE_OUT(2, layers);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  float g = FETCH(scale, 0).x;
  STORE(layers, n, exp(min(FETCH(solution, n) + vec4(g, g, g, -g), 60.0)));
}
