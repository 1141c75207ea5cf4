// SPDX-License-Identifier: LGPL-2.1-or-later
// The energy of chapter 5 of the thesis and the linear systems of its Gauss-Newton steps. Unknowns of a pixel: r = ln R
// (three), T_0 (direct light) and T_1...T_K (indirect light, one scalar for each base color b_k; b_0 is white).
//
//   E = Σ_x λ_data |I − R ⊙ S|²,  R = e^r,  S = Σ_k b_k T_k                            data              (5.4)
//     + λ_clustering |r − r_cluster|²                                                  clusters          (5.6)
//     + λ_r-sparsity Σ_y∈N(x) |r(x) − r(y)|^p                                          sparse r          (5.7)
//     + λ_r-consistency Σ_i g_i |r(x) − r_ti(y_i)|²                                    samples           (3.12)
//     + λ_monochrome w_SR |P S|²,  P = I − 11ᵀ/3                                       gray shading      (5.9)
//     + λ_i-sparsity Σ_k≥1 |T_k|                                                       sparse light      (5.11)
//     + λ_smoothness Σ_k |∇T_k|₁                                                       piecewise light   (5.12)
//     + λ_non-neg Σ_k max(−T_k, 0)                                                     positive light    (5.13)
//
//   w_SR = 1 − exp(−α_SR ΔC), ΔC the largest |c(x) − c(y)| to the four neighbors       (5.10)
//   c = (I + ε_c) / mean(I + ε_c);   g_i = 1 − w_intensity (1 − |I|) if |c − c_ti(y_i)| < τ_cc, else 0   (3.13)
//
// Σ_x Σ_y meets each edge twice, |∇T|₁ once. A step replaces |d|^p by c(d₀) |d|², c = f (|d₀|² + ε²)^(p/2 − 1), f = p/2
// (a bound of the norm) or 1 (5.16 as printed), and max(−T, 0) by w T², w = f/(|T₀| + ε) if T₀ ≤ 0, else 0 (5.6.4.1).
// With e = I − R ⊙ S, linearized, it solves A δ = b, half the gradient set to zero:
//
//   h = R ⊙ S ⊙ δr + R ⊙ Σ_k b_k δT_k
//   A δ |_r  = λ_data R ⊙ S ⊙ h + G δr + Σ_y a (δr − δr(y))
//   A δ |_Tk = b_k · (λ_data R ⊙ h + λ_monochrome w_SR P Σ b δT) + w_k δT_k + Σ_y v_k (δT_k − δT_k(y))
//   b |_r    = λ_data e ⊙ R ⊙ S + λ_clustering (r_cluster − r) + Σ g (r_t − r) − Σ_y a (r − r(y))
//   b |_Tk   = b_k · (λ_data e ⊙ R − λ_monochrome w_SR P S) − w_k T_k − Σ_y v_k (T_k − T_k(y))
//   G = λ_clustering + Σ g;   w_k: sparsity and non-negativity;   a, v_k: sparse r and piecewise light
//
// The weights of differences follow from x itself, which stays as it is within a step, so they are not stored.
//
// Fields (x, δ, residuals …) hold 1 + kGroups vec4 a pixel, one plane behind the other: (r, T_0), then four indirect
// layers a plane; the last plane may have layers without a base color, which stay zero. What else a pixel needs is packed
// into two planes of `nodes`: (R, λ_monochrome w_SR) and (R ⊙ S, G).

layout(constant_id = 2) const int kGroups = 4;  // planes of indirect layers
layout(constant_id = 3) const bool kUnitExponent = true;  // p is 1: no powers

const float kDarkest = 1e-6;  // mean shading below which a pixel has no light

layout(push_constant) uniform Push {
  ivec2 size;
  int count;          // partial sums to add up
  int mode;           // of a kernel with several (targets.comp, search.comp)
  int samples;        // N_s
  int frames;         // frames to draw from: the current one and the keyframes so far
  int ring_start;     // slot of the oldest keyframe, from 0
  int ring_capacity;  // keyframe slots
  int slot;           // slot to write, 0 is the current frame
  uint stream;        // of random positions (sample_frames.glsl): 0, as there is only one
  uint seed;
  int centers;        // slots of clusters
  int layers;         // K
  float lambda_data, lambda_clustering, lambda_r_sparsity, lambda_r_consistency, lambda_monochrome;
  float lambda_i_sparsity, lambda_smoothness, lambda_non_negativity;
  float p, irls_r, irls_light;  // irls: f for r and for T
  float alpha_sr, w_intensity;
  float sample_threshold;  // τ_cc² on the grid of packed chromaticities
  float epsilon, epsilon_r, log_floor, chroma_floor, indirect_start;
} push;
