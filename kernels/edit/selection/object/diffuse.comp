// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "object.glsl"

// A Jacobi step on alpha: the minimum of sum weight (alpha - p)^2 + sum edge (alpha_i - alpha_j)^2 in a cell, its neighbors fixed.
// Where color is certain, the first step starts from p, as the object may have moved.
layout(constant_id = 1) const bool FIRST = false;
PLANE_IN(0, terms);
SCALAR_IN(1, before);
SCALAR_OUT(2, alpha);
layout(push_constant) uniform Push { uvec2 cells; } push;

float alpha_of(int n) {
  float alpha = FETCH1(before, n);
  if (!FIRST) return alpha;
  vec2 prior = FETCH(terms, n).xy;
  return mix(alpha, prior.x / prior.y, min(prior.y / kPriorWeight, 1.0));
}

void main() {
  uvec2 cell = gl_GlobalInvocationID.xy;
  if (cell.x >= push.cells.x) return;
  int width = int(push.cells.x), n = int(cell.y) * width + int(cell.x);
  vec4 own = FETCH(terms, n);
  float sum = own.x, weight = own.y;
  if (cell.x > 0u) {
    sum += own.z * alpha_of(n - 1);
    weight += own.z;
  }
  if (cell.y > 0u) {
    sum += own.w * alpha_of(n - width);
    weight += own.w;
  }
  if (cell.x + 1u < push.cells.x) {
    float edge = FETCH(terms, n + 1).z;
    sum += edge * alpha_of(n + 1);
    weight += edge;
  }
  if (cell.y + 1u < push.cells.y) {
    float edge = FETCH(terms, n + width).w;
    sum += edge * alpha_of(n + width);
    weight += edge;
  }
  STORE(alpha, uint(n), sum / weight);
}
