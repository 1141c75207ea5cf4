// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"
#include "thesis/shared/sanitize.glsl"

// The image of the finest level.
PLANE_IN(0, frame);
PLANE_OUT(1, image);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  STORE(image, n, vec4(sanitized(FETCH(frame, n)), 1.0));
}
