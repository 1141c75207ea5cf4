// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#include "solve/conjugate_gradients.glsl"
#include "gpu/workgroup_sum.glsl"

// One workgroup: adds partial sums up and keeps the scalars of the conjugate gradients: rᵀz, α, β.
// mode 0: a new system, rᵀz is the sum. mode 1: α = rᵀz / sum.x. mode 2: β = sum / rᵀz.
// Where the curvature dᵀA d of a direction is not more than rounding of dᵀM d, rᵀz becomes 0, and the remaining iterations
// of this system change nothing.
PLANE_IN(0, partials);
SCALAR_INOUT(1, scalars);

void main() {
  vec4 sum = vec4(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < push.count; i += int(gl_WorkGroupSize.x)) {
    sum += FETCH(partials, i);
  }
  sum = workgroup_sum(sum);
  if (gl_LocalInvocationID.x != 0u) return;
  float rz = LOAD(scalars, 0);
  if (push.mode == 0) {
    STORE(scalars, 0, sum.x);
    STORE(scalars, 2, 0.0);
  } else if (push.mode == 1) {
    bool good = curves(sum.xy) && rz > 0.0;
    STORE(scalars, 1, good ? rz / sum.x : 0.0);
    STORE(scalars, 0, good ? rz : 0.0);
  } else {
    bool good = rz > 0.0;
    STORE(scalars, 2, good ? sum.x / rz : 0.0);
    STORE(scalars, 0, good ? sum.x : 0.0);
  }
}
