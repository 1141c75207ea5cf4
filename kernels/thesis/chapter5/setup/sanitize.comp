// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#include "thesis/chapter5/energy/terms.glsl"
#include "thesis/shared/sanitize.glsl"

// The image, and ln c, which the clusters are found in.
PLANE_IN(0, frame);
PLANE_OUT(1, image);
PLANE_OUT(2, chroma);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  vec3 light = sanitized(FETCH(frame, n));
  STORE(image, n, vec4(light, 1.0));
  STORE(chroma, n, vec4(log(chromaticity(light)), 0.0));
}
