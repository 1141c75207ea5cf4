// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "energy.glsl"

// One workgroup: adds the partial sums of both kinds of energy terms up into an entry of the trace.
PLANE_IN(0, local);
PLANE_IN(1, samples);
PLANE_OUT(2, trace);

void main() {
  vec4 sum = vec4(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < push.count; i += int(gl_WorkGroupSize.x)) {
    sum += FETCH(local, i) + FETCH(samples, i);
  }
  sum = workgroup_sum(sum);
  if (gl_LocalInvocationID.x == 0u) STORE(trace, push.slot, sum);
}
