// SPDX-License-Identifier: LGPL-2.1-or-later
// Shared by the multigrid kernels: the edges of coarse levels and the exact solve of one pack.

// Solves the tridiagonal system of a pack's four pixels: diagonal d, couplings w.x, w.y, w.z between neighbors (w.w to
// the next pack is in f already), right-hand side f. Pixels without equation (d = 0: padding) give 0. A mass millions of times
// smaller than the edges is lost to rounding in d: pivots are bounded from below by the rounding error of d.
vec4 solve_pack(vec4 d, vec4 w, vec4 f) {
  d = max(d, vec4(1e-20));
  vec4 min_pivot = 2.4e-7 * d;
  float p0 = 1.0 / d.x;
  float g0 = w.x * p0, y0 = f.x * p0;
  float p1 = 1.0 / max(d.y - w.x * g0, min_pivot.y);
  float g1 = w.y * p1, y1 = (f.y + w.x * y0) * p1;
  float p2 = 1.0 / max(d.z - w.y * g1, min_pivot.z);
  float g2 = w.z * p2, y2 = (f.z + w.y * y1) * p2;
  float s3 = (f.w + w.z * y2) / max(d.w - w.z * g2, min_pivot.w);
  float s2 = y2 + g2 * s3, s1 = y1 + g1 * s2;
  return vec4(y0 + g0 * s1, s1, s2, s3);
}

// Edges between aggregates of 2 x 2: the sums `crossing` of the edges over their border, in series with half of the stiffness
// inside either aggregate in the same direction, `before` and `after`; at min_pivot the share `min_pivot` of the sum. Weak edges
// between strong ones thus keep their weight: with less, the correction of a patch would overshoot, the more the larger the
// patch. A single pixel has no inner stiffness.
vec4 in_series(vec4 crossing, vec4 before, vec4 after, bvec4 single, float min_pivot) {
  vec4 resistance = 1.0 / max(before, vec4(1e-20)) + mix(1.0 / max(after, vec4(1e-20)), vec4(0.0), single);
  return crossing * max(vec4(min_pivot), 1.0 / (1.0 + 0.5 * crossing * resistance));
}
