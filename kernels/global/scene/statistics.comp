// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "global/model/model.glsl"

// One workgroup: the tint of the whole scene, from the sums of tint.comp.
PLANE_IN(0, sums);
PLANE_INOUT(1, scene);
layout(push_constant) uniform Push {
  int count;       // of sums
  float gate;      // mean square tint of a scene at which half of the residual counts
  float residual;  // max share of the residual
} push;

void main() {
  vec4 sum = vec4(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < push.count; i += int(gl_WorkGroupSize.x)) sum += FETCH(sums, i);
  sum = workgroup_sum(sum);
  if (gl_LocalInvocationID.x > 0u) return;
  float tint = sum.z / (sum.w + 1e-9);
  LOAD(scene, SCENE_TINT)[TINT_RMS] = sqrt(sum.x / (sum.y + 1e-9));
  LOAD(scene, SCENE_TINT)[TINT_RESIDUAL] = push.residual * tint / (tint + push.gate);
}
