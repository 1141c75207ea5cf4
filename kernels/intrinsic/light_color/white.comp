// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "light.glsl"
#include "solve/scale.glsl"

// What a frame's layers have to carry of the color of light: Role::slope. And for the next frame, how the exposure changed. One
// invocation.
PLANE_INOUT(0, light);
PLANE_IN(1, scale);
PLANE_OUT(2, slope);

void main() {
  if (gl_GlobalInvocationID.x > 0u) return;
  LOAD(light, LIGHT_FRAME).w += FETCH(scale, SCALE_LIGHT).w;
  vec4 now = LOAD(light, LIGHT_NOW), carried = vec4(0.0);
  carried[SLOPE_K] = now.x;
  carried[SLOPE_WHITE] = FETCH(scale, SCALE_STATE).w - (FETCH(scale, SCALE_NOW).x - FETCH(scale, SCALE_NOW).z);
  carried[SLOPE_CONFIDENCE] = now.z;
  carried[SLOPE_DONE] = LOAD(light, LIGHT_TARGET).w;
  STORE(slope, 0, carried);
}
