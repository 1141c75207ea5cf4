// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "samples.glsl"
#include "thesis/chapter3/clusters.glsl"

// The terms of the energy with a target: partial sums of (0, 0, 0, samples, clusters and stabilization).
PLANE_IN(8, solution);
PLANE_OUT(9, partials);
#define KNOWN_BINDING 10
#include "thesis/chapter4/known.glsl"

void main() {
  ivec2 at = ivec2(min(gl_GlobalInvocationID.x, uint(push.size.x - 1)), gl_GlobalInvocationID.y);
  int n = at.y * push.size.x + at.x;
  vec3 r = FETCH(solution, n).rgb;
  vec2 feature = sample_feature(n);
  float spread;
  draw_samples(n, feature.x, r, kCurrent | kKeyframes, spread);
  float energy = feature.y * spread;
  if (push.w_clustering > 0.0) {
    vec4 target = cluster_target(n);
    vec3 d = r - target.rgb;
    energy += target.w * dot(d, d);
  }
  vec4 known = known_at(n);
  vec3 off = r - known.rgb / max(known.w, 1e-20);
  energy += push.w_known * known.w * dot(off, off);
  SUM_PARTIALS(partials, vec4(0.0, 0.0, 0.0, gl_GlobalInvocationID.x < uint(push.size.x) ? energy : 0.0));
}
