// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#define TABLE_SLOT 0
#include "thesis/chapter5/energy/table.glsl"

// e = I − R ⊙ S and R, for the system of the base colors.
PLANE_IN(1, state);
PLANE_IN(2, image);
PLANE_OUT(3, residuals);
PLANE_OUT(4, reflectances);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int plane = push.size.x * push.size.y;
  int n = at.y * push.size.x + at.x;
  vec4 x = FETCH(state, n);
  vec3 s = vec3(x.w);
  for (int g = 1; g <= kGroups; ++g) s += (base_colors(g) * FETCH(state, g * plane + n)).rgb;
  vec3 reflectance = exp(x.rgb);
  STORE(residuals, n, vec4(FETCH(image, n).rgb - reflectance * s, 0.0));
  STORE(reflectances, n, vec4(reflectance, 0.0));
}
