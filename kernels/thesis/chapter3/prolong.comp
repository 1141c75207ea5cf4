// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"

// Bilinear interpolation from the coarser level; coarse pixel X lies on fine pixel 2X.
PLANE_IN(0, coarse);
PLANE_OUT(1, solution);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  ivec2 first = at / 2;
  ivec2 last = min((at + 1) / 2, push.other_size - 1);
  int top = first.y * push.other_size.x;
  int bottom = last.y * push.other_size.x;
  vec4 sum = FETCH(coarse, top + first.x) + FETCH(coarse, top + last.x) + FETCH(coarse, bottom + first.x) +
             FETCH(coarse, bottom + last.x);
  STORE(solution, at.y * push.size.x + at.x, 0.25 * sum);
}
