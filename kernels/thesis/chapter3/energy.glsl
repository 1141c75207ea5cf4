// SPDX-License-Identifier: LGPL-2.1-or-later
// The energies of chapters 3 and 4 of the thesis and the linear systems of their IRLS steps. Unknowns: one vec4 a pixel,
// x = (r_R, r_G, r_B, s), natural logarithms of reflectance and shading. i = ln max(I, log_floor), |I| = mean of I.
//
//   E = Σ_x w_data ω_l Σ_c ω_c (i_c − r_c − s)²                                       data              (3.5, 4.4)
//     + w_reflectance Σ_y∈N(x) ω_cs |r(x) − r(y)|^p                                   sparsity          (3.8)
//     + ω_l w_shading Σ_y∈N(x) (1 − ω_cs) (s(x) − s(y))²                              smooth shading    (3.9, 3.11)
//     + ω_l w_chromaticity |P (i − r)|²,  P = I − 11ᵀ/3                               chromaticity      (3.10)
//     + w_non_local Σ_i g_i |r(x) − r_ti(y_i)|²                                       samples           (3.12)
//     + ω_clustering |r(x) − r_cluster(x)|²                                           clusters          (3.14)
//     + w_u w_i (s(x) − ŝ_i)²  or  w_u w_i |r(x) − r̂_i|²                              stroke i          (4.7)
//     + w_s B |r(x) − r_model|²                                                       stabilization     (4.8)
//
//   ω_iw = 1 − w_intensity (1 − |I|)                                                  (3.6)
//   chapter 3: ω_l = ω_iw, ω_c of BT.601; chapter 4: ω_l = ω_c = 1, no clusters
//   ω_cs = w_cs exp(−α_cs |c(x) − c(y)|),  c = (I + ε_c) / mean(I + ε_c)              (3.7)
//   g_i = ω_iw if |c(x) − c_ti(y_i)| < τ_cc, else 0                                (3.13)
//   ω_clustering = w_clustering exp(−α_clustering |I|)                                (3.15)
//   ŝ_i, r̂_i: means over the stroke by the weights w_i, fixed within an IRLS step     (4.6.2)
//
// (3.10) is in log form, so that it is quadratic. Σ_x Σ_y meets each edge twice. An IRLS step replaces |d|^p by
// c(d₀) |d|², c = f (|d₀|² + ε²)^(p/2 − 1), f = p/2 (a majorizer) or 1 (3.19 as printed), and solves A x = b, half the
// gradient set to zero:
//
//   edge  (x,y):   a = 2 w_reflectance ω_cs c      V = w_shading (ω_l(x) + ω_l(y)) (1 − ω_cs)
//   A x |_rc = w_data ω_l ω_c (r_c + s) + G r_c + w_chromaticity ω_l (r_c − mean r) + Σ_y a (r_c − r_c(y))
//   A x |_s  = w_data ω_l Σ_c ω_c (r_c + s) + U s + Σ_y V (s − s(y))
//   b |_rc   = w_data ω_l ω_c i_c + w_chromaticity ω_l (i_c − mean i) + Σ g r_t + ω_clustering r_cluster + w_u w_i r̂_i + w_s B r_model
//   b |_s    = w_data ω_l Σ_c ω_c i_c + U ŝ_i   G = Σ g + ω_clustering + w_u w_i + w_s B   U = w_u w_i, each of strokes of its kind
//
// What a pixel needs is packed into two vectors:
//   edges = (a to the right, a down, V to the right, V down), zero across the border
//   node  = (ω_l, G, Σ a, U + Σ V)

#include "solve/conjugate_gradients.glsl"
#include "thesis/shared/packed_chromaticity.glsl"

layout(constant_id = 2) const int kChapter = 3;  // whose weights of data, smooth shading and chromaticity

layout(push_constant) uniform Push {
  ivec2 size;         // of the level
  ivec2 other_size;   // of the finer or coarser level, if there is one
  ivec2 shift;        // of the Schwarz blocks
  int count;          // partial sums to add up, or iterations inside a Schwarz block
  int samples;        // N_s
  int frames;         // frames to draw from: the current one and the keyframes so far
  int ring_start;     // slot of the oldest keyframe, from 0
  int ring_capacity;  // keyframe slots
  int slot;           // slot to write, 0 is the current frame
  uint stream;        // pyramid level, for the random numbers
  uint seed;
  float w_data, w_intensity, w_reflectance, w_shading, w_chromaticity, w_non_local;
  float w_clustering;  // 0: without the cluster prior
  float w_known;       // w_s; 0: nothing is known
  float w_cs, alpha_cs, alpha_clustering;
  float sample_threshold;  // τ_cc² on the grid of packed chromaticities
  float log_floor, chroma_floor;
  float p, epsilon2, irls_factor;
} push;

const vec3 kChannelWeight = vec3(0.299, 0.587, 0.114);  // ω_c, ITU-R BT.601

float mean3(vec3 v) { return (v.r + v.g + v.b) * (1.0 / 3.0); }

float intensity(vec3 image) { return clamp(mean3(image), 0.0, 1.0); }

float intensity_weight(vec3 image) { return 1.0 - push.w_intensity * (1.0 - intensity(image)); }

/// ω_l and ω_c.
float local_weight(vec3 image) { return kChapter == 4 ? 1.0 : intensity_weight(image); }
vec3 channel_weight() { return kChapter == 4 ? vec3(1.0) : kChannelWeight; }

vec3 chromaticity(vec3 image) { return (image + push.chroma_floor) / (mean3(image) + push.chroma_floor); }

float irls_weight(vec3 difference) {
  return push.irls_factor * pow(dot(difference, difference) + push.epsilon2, 0.5 * push.p - 1.0);
}

vec3 log_light(vec3 image) { return log(max(image, push.log_floor)); }

/// P v. Projected twice, so that its sum vanishes even against a rounding of v: times a large weight, what is left of it would
/// drive the gray values, which little else holds.
vec3 colored(vec3 v) {
  vec3 once = v - mean3(v);
  return once - mean3(once);
}

/// The data and chromaticity terms' part of b - A x at a pixel, i = log_light.
vec4 node_residual(vec4 node, vec3 i, vec4 x) {
  vec3 misfit = i - x.rgb;
  vec3 data = push.w_data * node.x * channel_weight() * (misfit - x.a);
  return vec4(data + push.w_chromaticity * node.x * colored(misfit), data.r + data.g + data.b);
}

/// The part of A v at a pixel that needs no neighbors, U = shading_weight. The rest is edges times differences of v: a sum over all edges less
/// the neighbors' share would lose what holds a patch in place against the edges inside it.
vec4 apply_node(vec4 node, float shading_weight, vec4 v) {
  vec3 data = push.w_data * node.x * channel_weight() * (v.rgb + v.a);
  vec3 chroma = push.w_chromaticity * node.x * colored(v.rgb);
  return vec4(data + chroma + node.y * v.rgb, data.r + data.g + data.b + shading_weight * v.a);
}

/// diag(A) at a pixel.
vec4 diagonal(vec4 node) {
  vec3 r = push.w_data * node.x * channel_weight() + node.y + node.z + push.w_chromaticity * node.x * (2.0 / 3.0);
  return vec4(r, (kChapter == 4 ? 3.0 : 1.0) * push.w_data * node.x + node.w);
}
