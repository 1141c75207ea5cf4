// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "scalars.glsl"
#include "solve/conjugate_gradients.glsl"

// One workgroup: adds partial sums up and updates the scalars of the conjugate gradients. If the curvature dᵀA d of a direction
// is not more than rounding of dᵀM d, rᵀz becomes 0, and the remaining iterations of this system change nothing.
PLANE_IN(0, partials);
SCALAR_INOUT(1, scalars);
layout(push_constant) uniform Push {
  int count;        // partial sums
  int mode;
  int first;        // kSystem: 1 for the first of several systems
  float tolerance;  // of the residual in the preconditioner's norm, relative to the first system; 0: none
} push;

const int kSystem = 0;  // a new system: rᵀz is the sum
const int kAlpha = 1;   // α = rᵀz / sum.x
const int kBeta = 2;    // β = sum / rᵀz

void main() {
  vec4 sum = vec4(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < push.count; i += int(gl_WorkGroupSize.x)) {
    sum += FETCH(partials, i);
  }
  sum = workgroup_sum(sum);
  float total = sum.x;
  if (gl_LocalInvocationID.x != 0u) return;
  float rz = LOAD(scalars, CG_RZ);
  float bound = push.tolerance * push.tolerance;
  if (push.mode == kSystem) {
    float first = push.first == 1 ? total : LOAD(scalars, CG_FIRST_RZ);
    STORE(scalars, CG_RZ, total);
    STORE(scalars, CG_BETA, 0.0);
    STORE(scalars, CG_FIRST_RZ, first);
    STORE(scalars, CG_CONTINUES, total < bound * first ? 0.0 : 1.0);
  } else if (push.mode == kAlpha) {
    bool good = curves(sum.xy) && rz > 0.0;
    STORE(scalars, CG_ALPHA, good ? rz / total : 0.0);
    STORE(scalars, CG_RZ, good ? rz : 0.0);
  } else {
    bool good = rz > 0.0;
    STORE(scalars, CG_BETA, good ? total / rz : 0.0);
    STORE(scalars, CG_RZ, good ? total : 0.0);
    STORE(scalars, CG_CONTINUES, total < bound * LOAD(scalars, CG_FIRST_RZ) ? 0.0 : 1.0);
    STORE(scalars, CG_ITERATIONS, LOAD(scalars, CG_ITERATIONS) + 1.0);
  }
}
