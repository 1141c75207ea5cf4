// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"

// Convergence after a cycle. One workgroup.
#define PROGRESS_CHANGE 0     // mean square, by the last cycle
#define PROGRESS_CONTINUES 1  // 1 if another cycle is needed, or 0
#define PROGRESS_CYCLES 2     // so far
PLANE_IN(0, sums);  // partial sums of squares
PLANE_INOUT(1, progress);  // one vec4, in which they are
layout(push_constant) uniform Push {
  uint count;     // of `sums`
  float pixels;
  float tolerance;  // mean square change that is not worth another cycle
  uint first;     // 1 in a frame's first measurement
} push;

void main() {
  vec4 sum = vec4(0.0);
  for (uint i = gl_LocalInvocationID.x; i < push.count; i += gl_WorkGroupSize.x) sum += FETCH(sums, int(i));
  float change = workgroup_sum(sum).x / push.pixels;
  if (gl_LocalInvocationID.x > 0u) return;
  vec4 now = vec4(0.0);
  now[PROGRESS_CHANGE] = change;
  now[PROGRESS_CONTINUES] = change < push.tolerance ? 0.0 : 1.0;
  now[PROGRESS_CYCLES] = push.first == 1u ? 1.0 : LOAD(progress, 0)[PROGRESS_CYCLES] + 1.0;
  STORE(progress, 0, now);
}
