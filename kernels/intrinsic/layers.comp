#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"
#include "guide.glsl"
#include "temporal.glsl"

// The solution as layers in the output's gauge c, S = e^s / c and R = I / S, and what the next frame wants to know of this
// one. One cell, 4 x 4 pixels, an invocation.
PLANE_IN(0, frame);
PLANE_IN(1, shading);
PLANE_IN(2, cells);
PLANE_IN(3, wide);
PLANE_IN(4, gauge);  // .x = ln c (gauge.comp)
PLANE_OUT(5, intrinsic);
PLANE_OUT(6, kept);
layout(push_constant) uniform Push { uvec2 size; } push;

void main() {
  uint quads = QUADS(push.size.x);
  uvec2 cell = grid_position(quads);
  uint first = 4u * cell.y;
  if (first >= push.size.y) return;
  uvec2 count = min(push.size - 4u * cell, uvec2(4u));
  float scale = FETCH(gauge, 0).x;
  for (uint y = 0u; y < count.y; ++y) {
    vec4 s = FETCH(shading, int((first + y) * quads + cell.x));
    for (uint x = 0u; x < count.x; ++x) {
      uint pixel = (first + y) * push.size.x + 4u * cell.x + x;
      vec3 rgb = sanitize(FETCH(frame, int(pixel)).rgb);
      STORE(intrinsic, pixel, vec4(rgb * exp(scale - s.x), exp(s.x - scale)));
      s = s.yzwx;
    }
  }
  uint at = cell.y * quads + cell.x;
  vec4 guide = FETCH(cells, int(CELL_STRIDE * at));
  STORE(kept, at, cell_state(guide, FETCH(wide, int((cell.y / 4u) * QUADS(quads) + cell.x / 4u))));
}
