// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "samples.glsl"
#include "thesis/chapter3/clusters.glsl"

// The terms of the energy with a target: partial sums of (0, 0, 0, samples and clusters).
PLANE_IN(8, solution);
PLANE_OUT(9, partials);

void main() {
  ivec2 at = ivec2(min(gl_GlobalInvocationID.x, uint(push.size.x - 1)), gl_GlobalInvocationID.y);
  int n = at.y * push.size.x + at.x;
  vec3 r = FETCH(solution, n).rgb;
  vec2 feature = sample_feature(n);
  float spread;
  draw_samples(n, feature.x, r, kCurrent | kKeyframes, spread);
  float energy = feature.y * spread;
  if (push.clustered == 1) {
    vec4 target = cluster_target(n);
    vec3 d = r - target.rgb;
    energy += target.w * dot(d, d);
  }
  SUM_PARTIALS(partials, vec4(0.0, 0.0, 0.0, gl_GlobalInvocationID.x < uint(push.size.x) ? energy : 0.0));
}
