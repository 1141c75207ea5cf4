#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"
#include "quad.glsl"

// One IRLS step: freezes the robust weights at s and writes the system's edges and right-hand side (energy.glsl). A strip
// of kRows quads an invocation; the left edge's weight is computed again rather than exchanged.
layout(constant_id = 1) const uint kRows = 4;
layout(constant_id = 2) const int kExponent = 0;  // p where it is 1 or 2, else 0
PLANE_IN(0, shading);
PLANE_IN(1, mean);
PLANE_IN(2, right_edges);
PLANE_IN(3, down_edges);
PLANE_IN(4, anchored);  // the pixels' own right-hand side
PLANE_OUT(5, system);
layout(push_constant) uniform Push {
  uvec2 size;
  float p;
  float floor2;  // e^2
} push;

// The frozen weight of the edges at `at`, whose reflectance steps are `step`; quick ways for p = 1 and p = 2.
vec4 robust(vec4 z) {
  if (kExponent == 1) return 1.5 * inversesqrt(z + push.floor2);
  if (kExponent == 2) return vec4(3.0);
  return (1.5 * push.p) * pow(z + push.floor2, vec4(0.5 * push.p - 1.0));
}
#define WEIGHT(edges, at, step)                     \
  (FETCH(edges, EDGE_STRIDE * (at) + EDGE_SPARSE) * \
   robust(3.0 * (step) * (step) + FETCH(edges, EDGE_STRIDE * (at) + EDGE_CHROMA)))

void main() {
  uint quads = QUADS(push.size.x);
  uvec2 position = grid_position(quads);
  uint x = position.x, first = position.y * kRows, last = min(first + kRows, push.size.y);
  if (first >= push.size.y) return;
  int next = int(min(x + 1u, quads - 1u)) - int(x), before = x > 0u ? -1 : 0;
  float has_left = x > 0u ? 1.0 : 0.0;
  int at = int(first * quads + x);
  vec4 m = FETCH(mean, at), r = m - FETCH(shading, at);
  vec4 above = vec4(0.0);  // the part of the edge from the row above
  if (first > 0u) {
    int up = at - int(quads);
    vec4 um = FETCH(mean, up), step = um - FETCH(shading, up) - r;
    above = WEIGHT(down_edges, up, step) * (m - um);
  }
  for (uint y = first; y < last; ++y) {
    vec4 nm = FETCH(mean, at + next), nr = nm - FETCH(shading, at + next), step = r - SHIFT_LEFT(r, nr);
    vec4 weight = WEIGHT(right_edges, at, step);
    STORE(system, SYSTEM_STRIDE * at + SYSTEM_RIGHT, weight + FETCH(right_edges, EDGE_STRIDE * at + EDGE_SMOOTH));
    vec4 flow = weight * (m - SHIFT_LEFT(m, nm));
    vec4 lm = FETCH(mean, at + before);
    step = lm - FETCH(shading, at + before) - r.x;  // only its last pixel is a neighbor
    vec4 left = has_left * WEIGHT(right_edges, at + before, step) * (lm - m.x);
    int below = at + (y + 1u < push.size.y ? int(quads) : 0);
    vec4 bm = FETCH(mean, below), br = bm - FETCH(shading, below);
    step = r - br;
    weight = WEIGHT(down_edges, at, step);
    STORE(system, SYSTEM_STRIDE * at + SYSTEM_DOWN, weight + FETCH(down_edges, EDGE_STRIDE * at + EDGE_SMOOTH));
    vec4 fall = weight * (m - bm);
    STORE(system, SYSTEM_STRIDE * at + SYSTEM_RHS, FETCH(anchored, at) + flow - SHIFT_RIGHT(flow, left) + fall + above);
    above = -fall;
    m = bm;
    r = br;
    at += int(quads);
  }
}
