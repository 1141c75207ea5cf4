#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"

// With how much force the cells' terms pull at s' as it stands after a correction: wanted - screen (s' + correction). The
// finer levels relax against it. One quad of cells an invocation.
PLANE_IN(0, terms);
PLANE_IN(1, wanted);
PLANE_IN(2, mean);
PLANE_IN(3, correction);
PLANE_OUT(4, force);
layout(push_constant) uniform Push { uvec2 size; } push;  // of level 2

void main() {
  uvec2 position = grid_position(QUADS(push.size.x));
  if (position.y >= push.size.y) return;
  int at = int(position.y * QUADS(push.size.x) + position.x);
  vec4 pull = FETCH(wanted, at) - FETCH(terms, TERMS_STRIDE * at + TERMS_SCREEN) * (FETCH(mean, at) + FETCH(correction, at));
  STORE(force, FORCE_STRIDE * uint(at) + FORCE_PULL, MASKED(pull, INSIDE(position.x, push.size.x)));
}
