// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#include "gpu/workgroup_sum.glsl"

// One workgroup for each entry of the system: adds its `count` partial sums up.
PLANE_IN(0, partials);
PLANE_OUT(1, entries);

void main() {
  int first = int(gl_WorkGroupID.x) * push.count;
  vec4 sum = vec4(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < push.count; i += int(gl_WorkGroupSize.x)) {
    sum += FETCH(partials, first + i);
  }
  sum = workgroup_sum(sum);
  if (gl_LocalInvocationID.x == 0u) STORE(entries, gl_WorkGroupID.x, sum);
}
