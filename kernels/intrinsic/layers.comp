#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"
#include "guide.glsl"

// The solution as layers, S = e^s and R = I / S, and what the next frame wants to know of this one (temporal.glsl). One
// quad an invocation.
PLANE_IN(0, frame);
PLANE_IN(1, shading);
PLANE_IN(2, level0);
PLANE_IN(3, cells);
PLANE_OUT(4, intrinsic);
PLANE_OUT(5, kept);
layout(push_constant) uniform Push { uvec2 size; } push;

void main() {
  uint quads = QUADS(push.size.x);
  uvec2 position = grid_position(quads);
  if (position.y >= push.size.y) return;
  vec4 s = FETCH(shading, int(position.y * quads + position.x));
  float cell_mean = FETCH(cells, int(CELL_STRIDE * ((position.y / 4u) * quads + position.x))).x;
  uint first = 4u * position.x;
  for (uint x = first; x < min(first + 4u, push.size.x); ++x) {
    uint pixel = position.y * push.size.x + x;
    vec4 guide = FETCH(level0, int(pixel));
    vec3 rgb = sanitize(FETCH(frame, int(pixel)).rgb);
    STORE(intrinsic, pixel, vec4(rgb * exp(-s.x), exp(s.x)));
    STORE(kept, pixel, vec4(guide.x - cell_mean, guide.yz, guide.x - s.x));
    s = s.yzwx;
  }
}
