// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Marked regions, one of them with a base color on trial.
layout(push_constant) uniform Push {
  ivec2 size;
  int number;
  int color;  // its slot
} push;
PLANE_IN(0, regions);
PLANE_OUT(1, trial);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  vec4 region = FETCH(regions, n);
  STORE(trial, n, int(region.y) == push.number ? vec4(float(push.color), region.yzw) : region);
}
