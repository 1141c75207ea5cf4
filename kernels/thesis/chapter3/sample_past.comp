// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"
#include "thesis/shared/sample_frames.glsl"

// The pulls of a pixel that stay the same while a level is solved: samples from keyframes and, in mode 1, the cluster.
PLANE_IN(6, image);
PLANE_IN(7, clusters);  // (r_cluster, index), index < 0 if there is none
PLANE_OUT(8, pulls);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  vec3 here = FETCH(image, n).rgb;
  float spread;
  vec4 sum = draw_samples(n, pack_chromaticity(chromaticity(here)), vec3(0.0), kKeyframes, spread);
  vec4 pull = push.w_non_local * intensity_weight(here) * sum;
  if (push.mode == 1) {
    vec4 cluster = FETCH(clusters, n);
    float weight = push.w_clustering * exp(-push.alpha_clustering * intensity(here));
    pull += (cluster.w < 0.0 ? 0.0 : weight) * vec4(cluster.rgb, 1.0);
  }
  STORE(pulls, n, pull);
}
