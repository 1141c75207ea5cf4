// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "samples.glsl"
#include "thesis/chapter3/clusters.glsl"

// The source terms that are constant while a level is solved: samples from keyframes, and the cluster if there are any.
const int kSampled = kKeyframes;
vec4 other_sources(int n) {
  if (push.clustered == 0) return vec4(0.0);
  vec4 target = cluster_target(n);
  return target.w * vec4(target.rgb, 1.0);
}

#include "thesis/shared/sample.glsl"
