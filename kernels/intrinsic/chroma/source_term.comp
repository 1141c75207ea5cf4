// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/energy/energy.glsl"

// The source term of the cells at s' after a correction: g (target - s' - correction). The finer levels relax against it. One pack of
// cells an invocation.
PLANE_IN(0, terms);
PLANE_IN(1, target);
PLANE_IN(2, mean);
PLANE_IN(3, correction);
PLANE_OUT(4, source_term);
layout(push_constant) uniform Push { uvec2 size; } push;  // of level 2

void main() {
  uvec2 position = grid_position(PACK4(push.size.x));
  if (position.y >= push.size.y) return;
  int at = int(position.y * PACK4(push.size.x) + position.x);
  vec4 off = FETCH(target, at) - FETCH(mean, at) - FETCH(correction, at);
  STORE(source_term, SOURCE_STRIDE * uint(at) + SOURCE_VALUE,
        MASKED(FETCH(terms, TERMS_STRIDE * at + TERMS_CHROMA) * off, INSIDE(position.x, push.size.x)));
}
