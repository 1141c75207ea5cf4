// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"

// Writes the reflectance of a solution into a slot of a buffer of sample frames.
PLANE_IN(0, state);
PLANE_IN(1, features);
PLANE_OUT(2, frames);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  STORE(frames, push.slot * push.size.x * push.size.y + n, vec4(FETCH(state, n).rgb, FETCH(features, n).x));
}
