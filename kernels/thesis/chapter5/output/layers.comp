// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#define TABLE_SLOT 0
#include "thesis/chapter5/energy/table.glsl"

// The layers: (R, S), S the mean of the shading, and the color of the light with the share of S that is direct,
// (Σ_k b_k T_k / S, T_0 / S). Light that the penalty left below zero is none; if there is no light, it is white.
PLANE_IN(1, state);
PLANE_OUT(2, intrinsic);
PLANE_OUT(3, light);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int plane = push.size.x * push.size.y;
  int n = at.y * push.size.x + at.x;
  vec4 x = FETCH(state, n);
  float direct = max(x.w, 0.0);
  vec3 s = vec3(direct);
  for (int g = 1; g <= kGroups; ++g) s += (base_colors(g) * max(FETCH(state, g * plane + n), 0.0)).rgb;
  float mean = (s.r + s.g + s.b) * (1.0 / 3.0);
  STORE(intrinsic, n, vec4(exp(x.rgb), mean));
  STORE(light, n, mean > kDarkest ? vec4(s, direct) / mean : vec4(1.0));
}
