// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"

// How sparse the indirect light of a region is (5.5.2.2): partial sums of (Σ_k |T_k|, pixels) in region `slot`.
PLANE_IN(0, state);
PLANE_IN(1, regions);
PLANE_OUT(2, partials);

void main() {
  int w = push.size.x;
  int plane = w * push.size.y;
  int n = int(gl_GlobalInvocationID.y) * w + int(min(gl_GlobalInvocationID.x, uint(w - 1)));
  float score = 0.0;
  for (int g = 1; g <= kGroups; ++g) score += dot(abs(FETCH(state, g * plane + n)), vec4(1.0));
  bool inside = gl_GlobalInvocationID.x < uint(w) && int(FETCH(regions, n).y) == push.slot;
  SUM_PARTIALS(partials, inside ? vec4(score, 1.0, 0.0, 0.0) : vec4(0.0));
}
