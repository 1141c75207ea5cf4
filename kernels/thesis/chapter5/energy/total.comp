// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"
#include "gpu/workgroup_sum.glsl"

// One workgroup: adds the partial sums of an energy up into two entries of the trace.
PLANE_IN(0, first);
PLANE_IN(1, samples);
PLANE_IN(2, second);
PLANE_OUT(3, trace);

void main() {
  vec4 a = vec4(0.0), b = vec4(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < push.count; i += int(gl_WorkGroupSize.x)) {
    a += FETCH(first, i) + FETCH(samples, i);
    b += FETCH(second, i);
  }
  a = workgroup_sum(a);
  b = workgroup_sum(b);
  if (gl_LocalInvocationID.x == 0u) {
    STORE(trace, 2 * push.slot, a);
    STORE(trace, 2 * push.slot + 1, b);
  }
}
