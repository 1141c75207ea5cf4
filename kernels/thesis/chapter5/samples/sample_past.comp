// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#include "thesis/shared/sample_frames.glsl"

// The pulls of a pixel that stay the same throughout a frame: clusters and samples from keyframes,
// (Σ g r_t + λ r_cluster, Σ g + λ_clustering).
PLANE_IN(6, features);
PLANE_IN(7, targets);
PLANE_OUT(8, pulls);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  vec4 feature = FETCH(features, n);
  vec4 goal = FETCH(targets, n);
  float spread;
  vec4 sum = draw_samples(n, feature.x, vec3(0.0), kKeyframes, spread);
  STORE(pulls, n, vec4(goal.rgb * goal.w, goal.w) + push.lambda_r_consistency * feature.y * sum);
}
