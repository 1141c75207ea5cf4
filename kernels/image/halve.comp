// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// One pyramid level: each coarse pixel is the mean of the existing ones of its 2x2 fine pixels.
PLANE_IN(0, fine);
PLANE_OUT(1, coarse);
layout(push_constant) uniform Push {
  uvec2 fine_size, size;
  uint first_row;
} push;

void main() {
  uvec2 at = gl_GlobalInvocationID.xy + uvec2(0u, push.first_row);
  if (at.x >= push.size.x) return;
  uvec2 first = at * 2u;
  uvec2 last = min(first + 1u, push.fine_size - 1u);
  uint top = first.y * push.fine_size.x;
  uint bottom = last.y * push.fine_size.x;
  vec4 sum = FETCH(fine, int(top + first.x)) + FETCH(fine, int(top + last.x)) +
             FETCH(fine, int(bottom + first.x)) + FETCH(fine, int(bottom + last.x));
  STORE(coarse, BY_ROWS(at.y * push.size.x + at.x), sum * 0.25);  // a missing pixel counts its neighbor twice: same mean
}
