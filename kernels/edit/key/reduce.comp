// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Cells of twice the side: rgb is their mean weighted by w, and w the mean of that.
PLANE_IN(0, fine);
PLANE_OUT(1, coarse);
layout(push_constant) uniform Push {
  uvec2 from;
  uvec2 to;
} push;

void main() {
  uvec2 cell = gl_GlobalInvocationID.xy;
  if (cell.x >= push.to.x) return;
  vec4 sum = vec4(0.0);
  float count = 0.0;
  for (uint y = 2u * cell.y; y < min(2u * cell.y + 2u, push.from.y); ++y)
    for (uint x = 2u * cell.x; x < min(2u * cell.x + 2u, push.from.x); ++x) {
      vec4 part = FETCH(fine, int(y * push.from.x + x));
      sum += vec4(part.rgb * part.w, part.w);
      count += 1.0;
    }
  STORE(coarse, cell.y * push.to.x + cell.x, sum.w > 0.0 ? vec4(sum.rgb / sum.w, sum.w / count) : vec4(0.0));
}
