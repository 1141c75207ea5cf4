#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"
#include "quad.glsl"

// The hand-made edge prior: per edge a, Q and b of energy.glsl from the chroma step. A strip of kRows quads an
// invocation, edges to the right and downwards.
//   cs = e^(-alpha sqrt(Q))   a = w_r cs   b = w_s max(1 - cs, beta)
layout(constant_id = 1) const uint kRows = 4;
PLANE_IN(0, chroma0);
PLANE_IN(1, chroma1);
PLANE_OUT(2, right_edges);
PLANE_OUT(3, down_edges);
layout(push_constant) uniform Push {
  uvec2 size;
  float sparsity;    // w_r
  float smoothness;  // w_s
  float alpha;
  float beta;
} push;

#define STORE_EDGES(target, at, d0, d1, exist)                                                \
  {                                                                                           \
    vec4 q = 0.5 * (d0) * (d0) + (2.0 / 3.0) * (d1) * (d1);                                   \
    vec4 cs = exp(-push.alpha * sqrt(q));                                                     \
    STORE(target, EDGE_STRIDE * (at) + EDGE_SPARSE, MASKED(push.sparsity * cs, exist));       \
    STORE(target, EDGE_STRIDE * (at) + EDGE_CHROMA, MASKED(q, exist));                        \
    STORE(target, EDGE_STRIDE * (at) + EDGE_SMOOTH,                                           \
          MASKED(push.smoothness * max(1.0 - cs, push.beta), exist));                         \
  }

void main() {
  uint quads = QUADS(push.size.x);
  uvec2 position = grid_position(quads);
  uint x = position.x, first = position.y * kRows, last = min(first + kRows, push.size.y);
  if (first >= push.size.y) return;
  bvec4 inside = INSIDE(x, push.size.x), has_right = HAS_RIGHT(x, push.size.x);
  uint next = min(x + 1u, quads - 1u);
  vec4 c0 = FETCH(chroma0, int(first * quads + x)), c1 = FETCH(chroma1, int(first * quads + x));
  for (uint y = first; y < last; ++y) {
    uint row = y * quads;
    vec4 n0 = FETCH(chroma0, int(row + next)), n1 = FETCH(chroma1, int(row + next));
    STORE_EDGES(right_edges, row + x, c0 - SHIFT_LEFT(c0, n0), c1 - SHIFT_LEFT(c1, n1), has_right);
    bool has_down = y + 1u < push.size.y;
    int below = int(row + (has_down ? quads : 0u) + x);
    vec4 b0 = FETCH(chroma0, below), b1 = FETCH(chroma1, below);
    STORE_EDGES(down_edges, row + x, c0 - b0, c1 - b1, bvec4(uvec4(inside) * uint(has_down)));
    c0 = b0;
    c1 = b1;
  }
}
