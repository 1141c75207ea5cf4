// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"
#include "thesis/shared/sample_frames.glsl"

// The pulls of a pixel that change with every IRLS step: what does not change plus samples from the current frame,
// (Σ g r_t + ω_cl r_cl, Σ g + ω_cl).
PLANE_IN(6, image);
PLANE_IN(7, constant_pulls);
PLANE_OUT(8, pulls);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  vec3 here = FETCH(image, n).rgb;
  float spread;
  vec4 sum = draw_samples(n, pack_chromaticity(chromaticity(here)), vec3(0.0), kCurrent, spread);
  STORE(pulls, n, FETCH(constant_pulls, n) + push.w_non_local * intensity_weight(here) * sum);
}
