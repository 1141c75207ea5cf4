// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"

// Convergence after a cycle. One workgroup.
//   progress[0] = mean square change by the last cycle, 1 if another cycle is needed or 0, cycles so far, -
PLANE_IN(0, sums);  // partial sums of squares
PLANE_INOUT(1, progress);
layout(push_constant) uniform Push {
  uint count;     // of `sums`
  float pixels;
  float settled;  // mean square change that is not worth another cycle
  uint first;     // 1 in a frame's first measurement
} push;

void main() {
  vec4 sum = vec4(0.0);
  for (uint i = gl_LocalInvocationID.x; i < push.count; i += gl_WorkGroupSize.x) sum += FETCH(sums, int(i));
  float change = workgroup_sum(sum).x / push.pixels;
  if (gl_LocalInvocationID.x > 0u) return;
  float cycles = push.first == 1u ? 1.0 : LOAD(progress, 0).z + 1.0;
  STORE(progress, 0, vec4(change, change < push.settled ? 0.0 : 1.0, cycles, 0.0));
}
