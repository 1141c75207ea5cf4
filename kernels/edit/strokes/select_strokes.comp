// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"

// The weight of whatever stroke covers a pixel, as a selection. One pixel an invocation.
PLANE_IN(0, mask);
PLANE_OUT(1, selection);
layout(push_constant) uniform Push {
  uvec2 size;
  uint first_row;
} push;

void main() {
  uvec2 at = gl_GlobalInvocationID.xy + uvec2(0u, push.first_row);
  if (at.x >= push.size.x || at.y >= push.size.y) return;
  float here = FETCH(mask, int(at.y * PACK4(push.size.x) + at.x / 4u))[at.x & 3u];
  STORE(selection, BY_ROWS(at.y * push.size.x + at.x), vec4(2.0 * fract(here), 0.0, 0.0, 0.0));
}
