// SPDX-License-Identifier: LGPL-2.1-or-later
// A subject under two color gradients as one cosine lobe per pixel (Fyffe et al. 2009;
// docs/reference/methods/olatrelight.md).
//
// Light of radiance 1 from direction w in the solid angle dw gives a pixel  R_c(w) dw = a_c max(0, u·w)^p dw,  of albedo a_c
// in channel c. Lights of direction w shine with (1 + w_c)/2 in gradient A and (1 - w_c)/2 in B, so that
//   F = A + B = ∫ R dw = a 2 pi / (p + 1)          the subject under all lights
//   m = (A - B) / F, channel c over channel c      component c of the mean direction of R: albedo cancels
//     = u (p + 1) / (p + 2)                        1/2 for p = 0, 2/3 for p = 1 (Lambert), towards 1 for mirrors
// and R = F (p + 1) / (2 pi) max(0, u·w)^p. A single lobe has |m| ≥ 1/2.
// Below that, a share s = 2 |m| is the lobe of p = 0 and the rest is uniform, R = F ((1 - s) / (4 pi) + s / (2 pi)
// [u·w > 0]), whose mean direction is m again.
//
// The lights of a stage are a sum, not an integral. Of N lights, F = Σ R(w_i) and m F = Σ w_i R(w_i). So m first goes
// through a table that maps the mean direction of the sum to that of the integral. R = F max(0, u·w)^p / S(u, p), S = Σ
// max(0, u·w_i)^p, is the response to one light: all N of them give F.

const int kSide = 65;     // of the tables of u: vertices of an octahedron's map, borders included
const int kLevels = 13;   // of p: 2^(l/2) - 1
const float kLargestExponent = 63.0;

// u of length 1, on the octahedron unfolded to -1…1.
vec2 unfolded(vec3 u) {
  vec3 n = u / (abs(u.x) + abs(u.y) + abs(u.z));
  vec2 signs = vec2(n.x >= 0.0 ? 1.0 : -1.0, n.y >= 0.0 ? 1.0 : -1.0);
  return n.z >= 0.0 ? n.xy : (1.0 - abs(n.yx)) * signs;
}
vec3 folded(vec2 at) {
  float z = 1.0 - abs(at.x) - abs(at.y), below = max(-z, 0.0);
  vec2 xy = at - below * vec2(at.x >= 0.0 ? 1.0 : -1.0, at.y >= 0.0 ? 1.0 : -1.0);
  return normalize(vec3(xy, z));
}

// max(0, cosine)^p; for p = 0 half of the sphere.
float lobe_at(float cosine, float p) { return cosine > 0.0 ? exp2(p * log2(cosine)) : 0.0; }
