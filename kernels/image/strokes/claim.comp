// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"
#define ROOTS_SLOT 2
#include "image/components/components.glsl"

// Marks the components that have pixels of a stroke: those are filled.
PLANE_IN(0, mask);
PLANE_IN(1, labels);
WORD_OUT(3, claims);  // of roots
layout(push_constant) uniform Push { uvec2 size; } push;

void main() {
  uvec2 at = gl_GlobalInvocationID.xy;
  if (at.x >= push.size.x) return;
  uint n = at.y * push.size.x + at.x;
  if (FETCH(mask, int(at.y * PACK4(push.size.x) + at.x / 4u))[at.x & 3u] > 0.0 && FETCH(labels, int(n)).w >= 0.0)
    STORE(claims, root_of(n), 1u);
}
