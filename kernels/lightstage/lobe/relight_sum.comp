// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "lobe.glsl"

// The subject under lights, summed one after the other at every pixel: exact, in time proportional to their number.
PLANE_IN(0, full);
PLANE_IN(1, lobes);
PLANE_IN(2, lobe_values);    // w = 1/S(u, p)
PLANE_IN(3, lights);  // by twos: direction; weight
PLANE_OUT(4, picture);
layout(push_constant) uniform Push {
  vec4 even;  // what comes from everywhere gives: Σ weights / N
  uvec2 size;
  int lights;
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
  vec3 sum = vec3(0.0);
  for (int k = 0; k < push.lights; ++k)
    sum += FETCH(lights, 2 * k + 1).rgb * lobe_at(dot(FETCH(lights, 2 * k).xyz, u), lobe.w);
  vec3 light = mix(push.even.rgb, sum * lobe_table(u, lobe.w).w, min(share, 1.0));
  STORE(picture, BY_ROWS(i), vec4(f.rgb * light, f.w));
}
