// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "value.glsl"
#include "gpu/workgroup_sum.glsl"

// Four outputs of a dense node with bias and activation; one workgroup per block. Elements are read in memory order,
// and weights are stored to match: [block] of bias, then [block][channel][element], so that neighboring invocations
// read neighboring words.
PLANE_IN(0, image);
PLANE_IN(1, weights);
PLANE_OUT(2, result);
layout(push_constant) uniform Push {
  int elements, blocks;
  float slope;
} push;

void main() {
  int block = int(gl_WorkGroupID.x), n = push.elements;
  int weight = push.blocks + 4 * block * n;
  vec4 sum = vec4(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < n; i += int(gl_WorkGroupSize.x)) {
    vec4 v = FETCH(image, 1 + i);
    int w = weight + i;
    sum += v.r * FETCH(weights, w) + v.g * FETCH(weights, w + n) + v.b * FETCH(weights, w + 2 * n) +
           v.a * FETCH(weights, w + 3 * n);
  }
  sum = workgroup_sum(sum);
  if (gl_LocalInvocationID.x == 0u) STORE(result, 1 + block, activated(sum + FETCH(weights, block), push.slope));
}
