// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"

// The system of the base colors (5.7.1) from outer products: partial sums of Σ_x R² T_k T_l for layers k = y and l = z of
// the dispatch, l ≤ k, and of Σ_x R T_k e for l = K. Invocations run along the pixels, `count` of them.
PLANE_IN(0, state);
PLANE_IN(1, residuals);
PLANE_IN(2, reflectances);
PLANE_OUT(3, partials);

float layer(int k, int n) {
  vec4 lanes = FETCH(state, (1 + k / 4) * push.size.x * push.size.y + n);
  return lanes[k % 4];
}

void main() {
  int pixels = push.size.x * push.size.y;
  int k = int(gl_WorkGroupID.y), l = int(gl_WorkGroupID.z);
  bool right_hand_side = l == push.layers;
  int end = l <= k || right_hand_side ? pixels : 0;
  vec3 sum = vec3(0.0);
  for (int n = int(gl_GlobalInvocationID.x); n < end; n += push.count) {
    vec3 reflectance = FETCH(reflectances, n).rgb;
    vec3 other = right_hand_side ? FETCH(residuals, n).rgb : reflectance * layer(min(l, k), n);
    sum += reflectance * layer(k, n) * other;
  }
  SUM_PARTIALS(partials, vec4(sum, 0.0));
}
