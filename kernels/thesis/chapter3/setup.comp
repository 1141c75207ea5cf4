// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"

// Per-level constants: those of the edges, (2 w_r ω_cs, V).
PLANE_IN(0, image);
PLANE_OUT(1, links);

vec2 link(vec3 chroma, float weight, vec3 other, float exists) {
  vec3 d = chroma - chromaticity(other);
  float cs = push.w_cs * exp(-push.alpha_cs * sqrt(dot(d, d)));
  return exists * vec2(2.0 * push.w_reflectance * cs, push.w_shading * (weight + local_weight(other)) * (1.0 - cs));
}

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  bvec2 exists = lessThan(at + 1, push.size);
  vec3 here = FETCH(image, n).rgb;
  vec3 right = FETCH(image, exists.x ? n + 1 : n).rgb;
  vec3 below = FETCH(image, exists.y ? n + push.size.x : n).rgb;
  vec3 chroma = chromaticity(here);
  float weight = local_weight(here);
  vec2 to_right = link(chroma, weight, right, float(exists.x));
  vec2 down = link(chroma, weight, below, float(exists.y));
  STORE(links, n, vec4(to_right.x, down.x, to_right.y, down.y));
}
