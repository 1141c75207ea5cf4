// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "lobe.glsl"

// Response of lobes of all directions and exponents to the lights (lobe.glsl): rgb = Σ_k weight_k max(0, u·w_k)^p /
// S(u, p), so that relighting is one table lookup. One direction per invocation, all exponents: from each to the next
// but one, 2^(l/2) - 1 → 2^(l/2 + 1) - 1, is a square and a product.
//
// With `gains` it computes w = 1/S(u, p), from all lights of the stage with weight 1. S is at least a quarter of its
// value under as many uniform lights, for directions with few lights.
PLANE_IN(0, lights);   // by twos: direction; weight
PLANE_IN(1, gain);     // w = 1/S; anything if `gains`
PLANE_OUT(2, table);
layout(push_constant) uniform Push {
  int lights;
  uint gains;
} push;

void main() {
  int i = int(line_index());
  if (i >= kSide * kSide) return;
  int y = i / kSide;
  vec3 u = folded(vec2(i - y * kSide, y) * (2.0 / float(kSide - 1)) - 1.0);
  vec3 sums[kLevels];
  for (int l = 0; l < kLevels; ++l) sums[l] = vec3(0.0);
  for (int k = 0; k < push.lights; ++k) {
    vec3 weight = FETCH(lights, 2 * k + 1).rgb;
    float cosine = max(dot(FETCH(lights, 2 * k).xyz, u), 0.0);
    float even = cosine > 0.0 ? 1.0 : 0.0, odd = lobe_at(cosine, 0.41421356);
    for (int l = 0; l < kLevels; l += 2) {
      sums[l] += even * weight;
      even = even * even * cosine;
    }
    for (int l = 1; l < kLevels; l += 2) {
      sums[l] += odd * weight;
      odd = odd * odd * cosine;
    }
  }
  for (int l = 0; l < kLevels; ++l) {
    int to = l * kSide * kSide + i;
    if (push.gains != 0u) {
      float min_sum = 0.125 * float(push.lights) / exp2(0.5 * float(l));
      STORE(table, to, vec4(1.0 / max(sums[l].x, min_sum)));
    } else {
      STORE(table, to, vec4(sums[l] * FETCH(gain, to).w, 1.0));
    }
  }
}
