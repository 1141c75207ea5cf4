// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "samples.glsl"
#include "thesis/chapter3/clusters.glsl"

// The source terms that are constant while a level is solved: samples from keyframes, the cluster if there are any, and what is known.
#define KNOWN_BINDING 9
#include "thesis/chapter4/known.glsl"

const int kSampled = kKeyframes;
vec4 other_sources(int n) {
  vec4 sum = push.w_known * known_at(n);
  if (push.w_clustering == 0.0) return sum;
  vec4 target = cluster_target(n);
  return sum + target.w * vec4(target.rgb, 1.0);
}

#include "thesis/shared/sample.glsl"
