// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"
#include "image/strokes/strokes.glsl"

// Reflectance under strokes becomes their color: R' = R + w (color − R). One pixel an invocation.
PLANE_IN(0, intrinsic);
PLANE_IN(1, mask);
PLANE_IN(2, strokes);
PLANE_OUT(3, edited);
layout(push_constant) uniform Push {
  uvec2 size;
  uint first_row;
} push;

void main() {
  uvec2 at = gl_GlobalInvocationID.xy + uvec2(0u, push.first_row);
  if (at.x >= push.size.x || at.y >= push.size.y) return;
  uint n = at.y * push.size.x + at.x;
  vec4 layers = FETCH(intrinsic, int(n));
  float here = FETCH(mask, int(at.y * PACK4(push.size.x) + at.x / 4u))[at.x & 3u];
  if (here > 0.0)
    layers.rgb = mix(layers.rgb, FETCH(strokes, STROKE_STRIDE * (int(here) - 1) + STROKE_COLOR).rgb, 2.0 * fract(here));
  STORE(edited, BY_ROWS(n), layers);
}
