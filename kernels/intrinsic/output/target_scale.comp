// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/output/brightness.glsl"

// The scale of a frame alone, from the mean around a quantile of the counts; and clears the counts. One invocation.
//   target[0] = ln c less ln(white level), 1 or 0 if all of the frame is dark, -, -
WORD_INOUT(0, counts);
PLANE_OUT(1, target);
layout(push_constant) uniform Push { float quantile; } push;

void main() {
  if (gl_GlobalInvocationID.x > 0u) return;
  uint total = 0u;
  for (uint i = 0u; i < kBrightnessBins; ++i) total += LOAD(counts, i);
  // Ranks around the quantile, to either side by half of the share above it: a quantile alone jumps if it falls between two
  // surfaces.
  float center = push.quantile * float(total), reach = max(0.5 * (float(total) - center), 0.5);
  float low = clamp(center - reach, 0.0, max(float(total) - 0.5, 0.0)), high = min(center + reach, float(total));
  float below = 0.0, sum = 0.0;
  for (uint i = 0u; i < kBrightnessBins; ++i) {
    float above = below + float(LOAD(counts, i));
    sum += max(min(above, high) - max(below, low), 0.0) * brightness_of(i);
    below = above;
    STORE(counts, i, 0u);
  }
  STORE(target, 0, total == 0u ? vec4(0.0) : vec4(-sum / (high - low), 1.0, 0.0, 0.0));
}
