#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"
#include "guide.glsl"

// The pixels' right-hand side from the edges' flux, and where the solve starts: at the cells' start, with the pixels' own
// departure in max_c i from their cell. One quad an invocation.
PLANE_IN(0, flux);
PLANE_IN(1, start);
PLANE_IN(2, level0);
PLANE_IN(3, cells);
PLANE_OUT(4, system);  // of stride 3
PLANE_OUT(5, shading);
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
  vec4 around = FETCH(cells, CELL_STRIDE * int((position.y / 4u) * quads + position.x)), s = vec4(0.0);
  vec4 begin = FETCH(start, int((position.y / 4u) * QUADS(quads) + position.x / 4u));
  for (uint k = 0u; k < 4u; ++k) {
    uint x = min(4u * position.x + k, push.size.x - 1u);
    vec4 guide = FETCH(level0, int(position.y * push.size.x + x));
    s = vec4(s.yzw, guide.x + guide.w);
  }
  s += begin[position.x & 3u] - around.x - around.w;
  STORE(shading, uint(at), MASKED(s, INSIDE(position.x, push.size.x)));
}
