// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"
#include "thesis/shared/scalars.glsl"

// First half of a conjugate-gradient iteration: d = z + β d₀, q = A d, with partial sums of dᵀq and dᵀM d.
PLANE_IN(0, preconditioned);
PLANE_IN(1, previous);
PLANE_IN(2, edges);
PLANE_IN(3, nodes);
SCALAR_IN(4, scalars);
PLANE_OUT(5, directions);
PLANE_OUT(6, products);
PLANE_OUT(7, partials);
#define STROKE_BINDING 8
#include "thesis/chapter4/strokes.glsl"

const int kStrip = 8;

vec4 search(int n, float beta) {
  vec4 before = FETCH(previous, n);
  return FETCH(preconditioned, n) + (beta != 0.0 ? beta * before : vec4(0.0));
}

void main() {
  int w = push.size.x;
  int x = min(int(gl_GlobalInvocationID.x), w - 1);
  int first = int(gl_GlobalInvocationID.y) * kStrip;
  bool inside = int(gl_GlobalInvocationID.x) < w;
  int left = max(x - 1, 0);
  int right = min(x + 1, w - 1);
  float has_left = float(x > 0);
  float beta = FETCH1(scalars, CG_BETA);
  vec2 sum = vec2(0.0);

  int before = max(first - 1, 0) * w + x;
  vec4 here = search(first * w + x, beta);
  vec4 up = here - search(before, beta);
  vec2 edge_up = float(first > 0) * FETCH(edges, before).yw;
  for (int row = 0; row < kStrip; ++row) {
    int y = first + row;
    int base = min(y, push.size.y - 1) * w;
    int n = base + x;
    vec4 below = search(min(y + 1, push.size.y - 1) * w + x, beta);
    vec4 edge = FETCH(edges, n);
    vec2 edge_left = has_left * FETCH(edges, base + left).xz;
    vec4 node = FETCH(nodes, n);
    vec4 across = here - search(base + right, beta), down = here - below, back = here - search(base + left, beta);
    vec4 q = apply_node(node, shading_weight(x, min(y, push.size.y - 1)), here) + edge_up.xxxy * up + edge.yyyw * down + edge_left.xxxy * back + edge.xxxz * across;
    if (inside && y < push.size.y) {
      STORE(directions, n, here);
      STORE(products, n, q);
      sum += vec2(dot(here, q), dot(here, diagonal(node) * here));
    }
    edge_up = edge.yw;
    up = -down;
    here = below;
  }
  SUM_PARTIALS(partials, vec4(sum, 0.0, 0.0));
}
