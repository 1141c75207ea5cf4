// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#include "thesis/chapter5/energy/terms.glsl"

// A conjugate-gradient iteration ends: x += α d, z −= α M⁻¹q, with partial sums of zᵀMz. In place: every invocation reads
// its own pixels before it writes them. All planes of the field are one tall image here.
PLANE_IN(0, next);
PLANE_IN(1, preconditioned);
PLANE_IN(2, directions);
PLANE_IN(3, products);
PLANE_IN(4, diagonals);
SCALAR_IN(5, scalars);
PLANE_OUT(6, next_out);
PLANE_OUT(7, preconditioned_out);
PLANE_OUT(8, partials);

const int kStrip = 8;

void main() {
  int w = push.size.x;
  int h = push.size.y * (kGroups + 1);
  int x = min(int(gl_GlobalInvocationID.x), w - 1);
  bool inside = int(gl_GlobalInvocationID.x) < w;
  float alpha = FETCH1(scalars, 1);
  float sum = 0.0;
  for (int row = 0; row < kStrip; ++row) {
    int y = int(gl_GlobalInvocationID.y) * kStrip + row;
    int n = min(y, h - 1) * w + x;
    vec4 m = FETCH(diagonals, n);
    vec4 z = FETCH(preconditioned, n) - alpha * precondition(m, FETCH(products, n));
    vec4 result = FETCH(next, n) + alpha * FETCH(directions, n);
    if (inside && y < h) {
      STORE(next_out, n, result);
      STORE(preconditioned_out, n, z);
      sum += dot(z, m * z);
    }
  }
  SUM_PARTIALS(partials, vec4(sum, 0.0, 0.0, 0.0));
}
