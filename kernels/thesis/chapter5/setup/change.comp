// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#include "gpu/workgroup_sum.glsl"

// One workgroup: by how much the chroma of the frame's `count` parts changed from the frame before, on the average over its
// light; the other half of `cells` is the frame before.
PLANE_IN(0, cells);
PLANE_OUT(1, change);

const float kMaxChange = 0.5;  // of ln c; larger ones count as this

void main() {
  vec4 sum = vec4(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < push.count; i += int(gl_WorkGroupSize.x)) {
    vec4 now = FETCH(cells, push.slot * push.count + i);
    vec3 off = now.rgb - FETCH(cells, (1 - push.slot) * push.count + i).rgb;
    sum += vec4(now.w * min(length(off) / kMaxChange, 1.0), now.w, 0.0, 0.0);
  }
  sum = workgroup_sum(sum);
  if (gl_LocalInvocationID.x == 0u) STORE(change, 0, vec4(sum.x / (sum.y + 1e-9), 0.0, 0.0, 0.0));
}
