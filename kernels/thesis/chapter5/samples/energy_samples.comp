// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/samples/samples.glsl"

// The energy of the samples: partial sums of (0, 0, 0, samples).
PLANE_IN(7, state);
PLANE_OUT(8, partials);

void main() {
  ivec2 at = ivec2(min(gl_GlobalInvocationID.x, uint(push.size.x - 1)), gl_GlobalInvocationID.y);
  int n = at.y * push.size.x + at.x;
  vec2 feature = sample_feature(n);
  float spread;
  draw_samples(n, feature.x, FETCH(state, n).rgb, kCurrent | kKeyframes, spread);
  float energy = feature.y * spread;
  SUM_PARTIALS(partials, vec4(0.0, 0.0, 0.0, gl_GlobalInvocationID.x < uint(push.size.x) ? energy : 0.0));
}
