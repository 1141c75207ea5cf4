// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"

// Writes a solution into a slot of a buffer of sample frames.
PLANE_IN(0, image);
PLANE_IN(1, solution);
PLANE_OUT(2, frames);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  vec3 chroma = chromaticity(FETCH(image, n).rgb);
  STORE(frames, push.slot * push.size.x * push.size.y + n, vec4(FETCH(solution, n).rgb, pack_chromaticity(chroma)));
}
