#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"

// Four indirect layers, T_k as light: what the penalty left below zero is none. slot: the plane of the field.
PLANE_IN(0, state);
PLANE_OUT(1, indirect);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  STORE(indirect, n, max(FETCH(state, push.slot * push.size.x * push.size.y + n), 0.0));
}
