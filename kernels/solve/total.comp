// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"

// Adds partial sums up. One workgroup.
PLANE_IN(0, sums);
PLANE_OUT(1, total);
layout(push_constant) uniform Push { uint count; } push;

void main() {
  vec4 sum = vec4(0.0);
  for (uint i = gl_LocalInvocationID.x; i < push.count; i += gl_WorkGroupSize.x) sum += FETCH(sums, int(i));
  sum = workgroup_sum(sum);
  if (gl_LocalInvocationID.x == 0u) STORE(total, 0, sum);
}
