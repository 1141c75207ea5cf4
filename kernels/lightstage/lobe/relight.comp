// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "lobe.glsl"

// The subject under the lights of a table (light_table.comp).
PLANE_IN(0, full);
PLANE_IN(1, lobes);
PLANE_IN(2, lobe_values);
PLANE_OUT(3, picture);
layout(push_constant) uniform Push {
  vec4 even;  // what comes from everywhere gives: Σ weights / N
  uvec2 size;
  uint first_row;
} push;

#include "lobe_table.glsl"

void main() {
  uvec2 at = gl_GlobalInvocationID.xy + uvec2(0u, push.first_row);
  if (at.x >= push.size.x) return;
  uint i = at.y * push.size.x + at.x;
  vec4 f = FETCH(full, int(i)), lobe = FETCH(lobes, int(i));
  float share = length(lobe.xyz);
  vec3 u = share > 1e-6 ? lobe.xyz / share : vec3(0.0, 0.0, 1.0);
  vec3 light = mix(push.even.rgb, lobe_table(u, lobe.w).rgb, min(share, 1.0));
  STORE(picture, BY_ROWS(i), vec4(f.rgb * light, f.w));
}
