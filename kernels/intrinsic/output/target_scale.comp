// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/output/brightness.glsl"

// The scale of a frame alone, from the mean around a quantile of the counts, and the light of its brightest cells; and clears the
// counts. One invocation.
//   target[0] = ln c less ln(white level), 1 or 0 if all of the frame is dark, ln S of the brightest cells before scaling, -
WORD_INOUT(0, counts);
PLANE_OUT(1, target);
layout(push_constant) uniform Push { float quantile; } push;

uint total = 0u;

float bright_end() {
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
  return sum / (high - low);
}

float white_light() {
  float weights = 0.0, sum = 0.0;
  for (uint i = kBrightnessBins; i < 2u * kBrightnessBins; ++i) {
    float weight = float(LOAD(counts, i));
    weights += weight;
    sum += weight * brightness_of(i - kBrightnessBins);
    STORE(counts, i, 0u);
  }
  return weights > 0.0 ? sum / weights : 0.0;
}

void main() {
  if (gl_GlobalInvocationID.x > 0u) return;
  for (uint i = 0u; i < kBrightnessBins; ++i) total += LOAD(counts, i);
  vec4 goal = vec4(-bright_end(), 1.0, white_light(), 0.0);
  STORE(target, 0, total == 0u ? vec4(0.0) : goal);
}
