// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "samples.glsl"

// The source terms that are constant throughout a frame: clusters, and samples from keyframes.
PLANE_IN(7, targets);

const int kSampled = kKeyframes;
vec4 other_sources(int n) {
  vec4 target = FETCH(targets, n);
  return vec4(target.rgb * target.w, target.w);
}

#include "thesis/shared/sample.glsl"
