// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"

// The start on the coarsest level: reflectance and shading have the same magnitude, r = i/2, s = |i|/2.
PLANE_IN(0, image);
PLANE_OUT(1, solution);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  vec3 i = log_light(FETCH(image, n).rgb);
  STORE(solution, n, 0.5 * vec4(i, mean3(i)));
}
