// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"

// One step of the Gaussian pyramid (3.5.4): 5x5 binomial filter, every second pixel; borders repeat.
PLANE_IN(0, fine);
PLANE_OUT(1, coarse);

vec4 row(ivec2 at, int y) {
  int base = clamp(y, 0, push.other_size.y - 1) * push.other_size.x;
  int last = push.other_size.x - 1;
  int x = 2 * at.x;
  return FETCH(fine, base + max(x - 2, 0)) + FETCH(fine, base + min(x + 2, last)) +
         4.0 * (FETCH(fine, base + max(x - 1, 0)) + FETCH(fine, base + min(x + 1, last))) +
         6.0 * FETCH(fine, base + min(x, last));
}

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  vec4 sum = vec4(0.0);
  for (int d = -2; d <= 2; ++d) {
    float weight = d == 0 ? 6.0 : (abs(d) == 1 ? 4.0 : 1.0);
    sum += weight * row(at, 2 * at.y + d);
  }
  STORE(coarse, at.y * push.size.x + at.x, sum * (1.0 / 256.0));
}
