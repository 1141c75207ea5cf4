// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/finite.glsl"
#include "lobe.glsl"

// From a pair of gradients to F and the lobe (lobe.glsl). Input is made finite and non-negative first.
PLANE_IN(0, a);
PLANE_IN(1, b);
PLANE_IN(2, moments);  // xyz to be added to m, over a grid of m from -1 to 1
PLANE_OUT(3, full);    // F, w = alpha of A
PLANE_OUT(4, lobes);   // u s, w = p
layout(push_constant) uniform Push {
  uvec2 size;
  uint stride;       // pixels from a row to the next of a and b
  uint second;       // the column where b begins
  int grid;          // points along a side of the grid
  float noise2;      // square of the F that is as good as nothing
  float exponent;    // largest
  uint first_row;
} push;

vec3 corrected(vec3 m) {
  vec3 at = (m * 0.5 + 0.5) * float(push.grid - 1);
  ivec3 cell = clamp(ivec3(at), ivec3(0), ivec3(push.grid - 2));
  vec3 f = at - vec3(cell);
  int g = push.grid, i = (cell.z * g + cell.y) * g + cell.x, j = i + g * g;
  vec3 front = mix(mix(FETCH(moments, i).xyz, FETCH(moments, i + 1).xyz, f.x),
                   mix(FETCH(moments, i + g).xyz, FETCH(moments, i + g + 1).xyz, f.x), f.y);
  vec3 back = mix(mix(FETCH(moments, j).xyz, FETCH(moments, j + 1).xyz, f.x),
                  mix(FETCH(moments, j + g).xyz, FETCH(moments, j + g + 1).xyz, f.x), f.y);
  return m + mix(front, back, f.z);
}

void main() {
  uvec2 at = gl_GlobalInvocationID.xy + uvec2(0u, push.first_row);
  if (at.x >= push.size.x) return;
  uint i = at.y * push.size.x + at.x, from = at.y * push.stride + at.x;
  vec4 first = finite(FETCH(a, int(from))), second = finite(FETCH(b, int(from + push.second)));
  vec3 sum = first.rgb + second.rgb;
  // With hardly any light m is noise: it fades to 0, and is never 0/0.
  vec3 m = (first.rgb - second.rgb) * sum / (sum * sum + push.noise2);
  m *= min(1.0, inversesqrt(max(dot(m, m), 1e-12)));
  vec3 mean = corrected(m);
  float size = length(mean), limit = (push.exponent + 1.0) / (push.exponent + 2.0);
  float narrow = clamp(size, 0.5, limit);
  vec3 u = size > 1e-6 ? mean / size : vec3(0.0, 0.0, 1.0);
  STORE(full, BY_ROWS(i), vec4(sum, first.w));
  STORE(lobes, BY_ROWS(i), vec4(u * min(2.0 * size, 1.0), (2.0 * narrow - 1.0) / (1.0 - narrow)));
}
