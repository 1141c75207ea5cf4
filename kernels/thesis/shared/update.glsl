// SPDX-License-Identifier: LGPL-2.1-or-later
// Second half of a conjugate-gradient iteration: x += α d, z −= α M⁻¹q, with partial sums of zᵀMz. In place: every invocation
// reads its own pixels before it writes them. The includer defines int rows() and vec4 diagonal_at(int n), M of pixel n.
#include "thesis/shared/scalars.glsl"
PLANE_IN(0, solution);
PLANE_IN(1, preconditioned);
PLANE_IN(2, directions);
PLANE_IN(3, products);
SCALAR_IN(5, scalars);
PLANE_OUT(6, solution_out);
PLANE_OUT(7, preconditioned_out);
PLANE_OUT(8, partials);

const int kStrip = 8;

void main() {
  int w = push.size.x;
  int h = rows();
  int x = min(int(gl_GlobalInvocationID.x), w - 1);
  bool inside = int(gl_GlobalInvocationID.x) < w;
  float alpha = FETCH1(scalars, CG_ALPHA);
  float sum = 0.0;
  for (int row = 0; row < kStrip; ++row) {
    int y = int(gl_GlobalInvocationID.y) * kStrip + row;
    int n = min(y, h - 1) * w + x;
    vec4 m = diagonal_at(n);
    vec4 z = FETCH(preconditioned, n) - alpha * precondition(m, FETCH(products, n));
    vec4 result = FETCH(solution, n) + alpha * FETCH(directions, n);
    if (inside && y < h) {
      STORE(solution_out, n, result);
      STORE(preconditioned_out, n, z);
      sum += dot(z, m * z);
    }
  }
  SUM_PARTIALS(partials, vec4(sum, 0.0, 0.0, 0.0));
}
