// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"
#include "gpu/workgroup_sum.glsl"

// One workgroup: adds partial sums up and keeps the scalars of the conjugate gradients: rᵀz, α, β, the rᵀz with which the
// level's first system began, whether a further iteration is worth its time, 1 or 0, and how many the frame has had.
// mode 0: a new system (slot = 0: the level's first), rᵀz is the sum. mode 1: α = rᵀz / sum.x. mode 2: β = sum / rᵀz.
// Where a direction has no curvature rᵀz becomes 0, and the remaining iterations of this system change nothing.
PLANE_IN(0, partials);
SCALAR_INOUT(1, scalars);

void main() {
  vec4 sum = vec4(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < push.count; i += int(gl_WorkGroupSize.x)) {
    sum += FETCH(partials, i);
  }
  sum = workgroup_sum(sum);
  float total = sum.x;
  if (gl_LocalInvocationID.x != 0u) return;
  float rz = LOAD(scalars, 0);
  if (push.mode == 0) {
    float first = push.slot == 0 ? total : LOAD(scalars, 3);
    STORE(scalars, 0, total);
    STORE(scalars, 2, 0.0);
    STORE(scalars, 3, first);
    STORE(scalars, 4, total < push.settled * push.settled * first ? 0.0 : 1.0);
  } else if (push.mode == 1) {
    bool good = curves(sum.xy) && rz > 0.0;
    STORE(scalars, 1, good ? rz / total : 0.0);
    STORE(scalars, 0, good ? rz : 0.0);
  } else {
    bool good = rz > 0.0;
    STORE(scalars, 2, good ? total / rz : 0.0);
    STORE(scalars, 0, good ? total : 0.0);
    STORE(scalars, 4, total < push.settled * push.settled * LOAD(scalars, 3) ? 0.0 : 1.0);
    STORE(scalars, 5, LOAD(scalars, 5) + 1.0);
  }
}
