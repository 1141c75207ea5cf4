// SPDX-License-Identifier: LGPL-2.1-or-later
// Reflectance clusters (thesis, 3.4.4): a 30³ histogram of the reflectance with exponential averaging over time, weighted
// k-means over its bins, and merging of duplicates. All sums are of integers or in a fixed order: equal input gives equal clusters.
//
//   scale    g: e^(r + g) has its quantile at white_level; g ← g + decay (g_frame − g)
//   bins     h ← h + decay (h_frame − h), h = (pixels, Σ R); fade instead of decay if h_frame is 0
//   k-means  argmin_k |R_bin − C_k|², C_k ← Σ h R / Σ h
//   merge    b into the lower a if |c(C_a) − c(C_b)| < τ_cc and |ln mean C_a − ln mean C_b| < τ_intensity

const int kBins = 30;                       // per channel
const int kBinCount = kBins * kBins * kBins;
const int kScaleBins = 2048;                // of ln R from −16 to 16
#include "palette/max_clusters.glsl"

layout(push_constant) uniform Push {
  uvec2 size;
  int first;         // 1: no history yet
  int clusters;
  int iterations;
  uint frame;
  uint seed;
  float decay, fade;
  float apart;
  float tau_cc, tau_intensity, chroma_floor;
  float white_quantile, white_level;
  float fraction_scale;  // fixed point inside a bin
} push;
