// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"
#include "thesis/shared/sample_frames.glsl"

// The terms of the energy that pull to a target: partial sums of (0, 0, 0, samples and clusters).
// mode 1: with the cluster prior.
PLANE_IN(6, image);
PLANE_IN(7, clusters);
PLANE_IN(8, solution);
PLANE_OUT(9, partials);

void main() {
  ivec2 at = ivec2(min(gl_GlobalInvocationID.x, uint(push.size.x - 1)), gl_GlobalInvocationID.y);
  int n = at.y * push.size.x + at.x;
  vec3 here = FETCH(image, n).rgb;
  vec3 r = FETCH(solution, n).rgb;
  float spread;
  draw_samples(n, pack_chromaticity(chromaticity(here)), r, kCurrent | kKeyframes, spread);
  float energy = push.w_non_local * intensity_weight(here) * spread;
  if (push.mode == 1) {
    vec4 cluster = FETCH(clusters, n);
    vec3 d = r - cluster.rgb;
    float pull = push.w_clustering * exp(-push.alpha_clustering * intensity(here));
    energy += (cluster.w < 0.0 ? 0.0 : pull) * dot(d, d);
  }
  SUM_PARTIALS(partials, vec4(0.0, 0.0, 0.0, gl_GlobalInvocationID.x < uint(push.size.x) ? energy : 0.0));
}
