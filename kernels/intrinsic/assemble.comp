#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"

// The pixels' right-hand side from the edges' flux, and the start of the solve from the cells'. One quad an invocation.
PLANE_IN(0, flux);
PLANE_IN(1, start);
PLANE_OUT(2, system);  // of stride 3
PLANE_OUT(3, shading);
layout(push_constant) uniform Push { uvec2 size; } push;

void main() {
  uint quads = QUADS(push.size.x);
  uvec2 position = grid_position(quads);
  if (position.y >= push.size.y) return;
  int at = int(position.y * quads + position.x);
  vec4 right = FETCH(flux, FLUX_STRIDE * at + FLUX_RIGHT);
  float left = position.x > 0u ? FETCH(flux, FLUX_STRIDE * (at - 1) + FLUX_RIGHT).w : 0.0;
  vec4 sum = right - SHIFT_RIGHT(right, vec4(left)) + FETCH(flux, FLUX_STRIDE * at + FLUX_DOWN);
  if (position.y > 0u) sum -= FETCH(flux, FLUX_STRIDE * (at - int(quads)) + FLUX_DOWN);
  STORE(system, 3u * uint(at) + SYSTEM_RHS, sum);
  vec4 cell = FETCH(start, int((position.y / 4u) * QUADS(quads) + position.x / 4u));
  float s = cell[position.x & 3u];
  STORE(shading, uint(at), MASKED(vec4(s), INSIDE(position.x, push.size.x)));
}
