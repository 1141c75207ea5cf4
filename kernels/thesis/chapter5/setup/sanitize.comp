// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#include "thesis/chapter5/energy/terms.glsl"

// The input: NaN and -Inf become 0, +Inf 1, the rest is clamped to 0...65504; and ln c, which the clusters are found in.
PLANE_IN(0, frame);
PLANE_OUT(1, image);
PLANE_OUT(2, chroma);

float finite(float v) { return v > 0.0 ? (v <= 3.4028234e38 ? min(v, 65504.0) : 1.0) : 0.0; }

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  vec4 v = FETCH(frame, n);
  vec3 light = vec3(finite(v.r), finite(v.g), finite(v.b));
  STORE(image, n, vec4(light, 1.0));
  STORE(chroma, n, vec4(log(chromaticity(light)), 0.0));
}
