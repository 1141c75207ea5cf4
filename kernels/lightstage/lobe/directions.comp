// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/srgb.glsl"

// Draws the lobes' directions as a normal map: code values (1 + u)/2 in sRGB. Black without light.
PLANE_IN(0, full);
PLANE_IN(1, lobes);
PLANE_OUT(2, picture);
layout(push_constant) uniform Push {
  uvec2 size;
  float min_light;  // minimum F, summed over channels, of a lit pixel
  uint first_row;
} push;

void main() {
  uvec2 at = gl_GlobalInvocationID.xy + uvec2(0u, push.first_row);
  if (at.x >= push.size.x) return;
  uint i = at.y * push.size.x + at.x;
  vec4 f = FETCH(full, int(i)), lobe = FETCH(lobes, int(i));
  vec3 code = 0.5 + 0.5 * lobe.xyz * inversesqrt(max(dot(lobe.xyz, lobe.xyz), 1e-12));
  bool lit = f.r + f.g + f.b > push.min_light && dot(lobe.xyz, lobe.xyz) > 1e-12;
  STORE(picture, BY_ROWS(i), vec4(lit ? to_linear(code) : vec3(0.0), f.w));
}
