// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/finite.glsl"

// Reflectance of a frame, of which only the one before is decomposed: R I' / I, with its shading. One pixel an invocation.
PLANE_IN(0, before);       // R.rgb of the frame before
PLANE_IN(1, frame_before);
PLANE_IN(2, frame);
PLANE_OUT(3, reflectance);
layout(push_constant) uniform Push { uvec2 size; } push;

const float kFloor = 2e-3;  // linear light

void main() {
  uvec2 at = gl_GlobalInvocationID.xy;
  if (at.x >= push.size.x) return;
  int n = int(at.y * push.size.x + at.x);
  STORE(reflectance, n, finite(FETCH(before, n) * ((finite(FETCH(frame, n)) + kFloor) / (finite(FETCH(frame_before, n)) + kFloor))));
}
