// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#include "thesis/shared/sample_frames.glsl"

// The pulls of a pixel that change with every step: those that do not, plus samples from the current frame.
PLANE_IN(6, features);
PLANE_IN(7, constant_pulls);
PLANE_OUT(8, pulls);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  vec4 feature = FETCH(features, n);
  float spread;
  vec4 sum = draw_samples(n, feature.x, vec3(0.0), kCurrent, spread);
  STORE(pulls, n, FETCH(constant_pulls, n) + push.lambda_r_consistency * feature.y * sum);
}
