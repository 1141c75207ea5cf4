// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "value.glsl"
#include "gpu/workgroup_sum.glsl"

// The mean of every channel; one workgroup per block.
PLANE_IN(0, image);
PLANE_OUT(1, result);
layout(push_constant) uniform Push { int area; } push;

void main() {
  int block = int(gl_WorkGroupID.x);
  vec4 sum = vec4(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < push.area; i += int(gl_WorkGroupSize.x))
    sum += FETCH(image, 1 + block * push.area + i);
  sum = workgroup_sum(sum);
  if (gl_LocalInvocationID.x == 0u) STORE(result, 1 + block, sum / float(push.area));
}
