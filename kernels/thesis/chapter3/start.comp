// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"

// The start on the coarsest level: what is known of r; else reflectance and shading have the same magnitude, r = i/2, s = |i|/2.
PLANE_IN(0, image);
#define KNOWN_BINDING 1
#include "thesis/chapter4/known.glsl"
PLANE_OUT(2, solution);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  vec3 i = log_light(FETCH(image, n).rgb);
  vec4 start = 0.5 * vec4(i, mean3(i)), known = known_at(n);
  vec3 step = known.rgb - known.w * start.rgb;
  STORE(solution, n, start + vec4(step, -mean3(step)));
}
