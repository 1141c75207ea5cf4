// What the multigrid kernels share: the system's rows and the exact solve of one quad.

// Solves the tridiagonal system of a quad's four pixels: diagonal d, couplings w.x, w.y, w.z between neighbors (w.w to
// the next quad is in f already), right-hand side f. Pixels without equation (d = 0: padding) come out as 0.
vec4 solve_quad(vec4 d, vec4 w, vec4 f) {
  d = max(d, vec4(1e-20));
  float p0 = 1.0 / d.x;
  float g0 = w.x * p0, y0 = f.x * p0;
  float p1 = 1.0 / (d.y - w.x * g0);
  float g1 = w.y * p1, y1 = (f.y + w.x * y0) * p1;
  float p2 = 1.0 / (d.z - w.y * g1);
  float g2 = w.z * p2, y2 = (f.z + w.y * y1) * p2;
  float s3 = (f.w + w.z * y2) / (d.w - w.z * g2);
  float s2 = y2 + g2 * s3, s1 = y1 + g1 * s2;
  return vec4(y0 + g0 * s1, s1, s2, s3);
}
