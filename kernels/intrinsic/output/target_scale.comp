// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "intrinsic/output/brightness.glsl"

// The scale of a frame alone, from the mean around a quantile of the counts, and the light of its brightest cells; and clears the
// counts. One workgroup, of up to 256 invocations, each with adjacent bins.
//   target[0] = ln c less ln(white level), 1 or 0 if all of the frame is dark, ln S of the brightest cells before scaling, -
WORD_INOUT(0, counts);
PLANE_OUT(1, target);
layout(push_constant) uniform Push { float quantile; } push;

shared uint totals[256];

void main() {
  uint lane = gl_LocalInvocationID.x, width = (kBrightnessBins - 1u) / gl_WorkGroupSize.x + 1u;
  uint first = lane * width, end = min(first + width, kBrightnessBins), own = 0u;
  for (uint i = first; i < end; ++i) own += LOAD(counts, i);
  totals[lane] = own;
  barrier();
  uint before = 0u, total = 0u;
  for (uint other = 0u; other < gl_WorkGroupSize.x; ++other) {
    if (other == lane) before = total;
    total += totals[other];
  }
  // Ranks around the quantile, to either side by half of the share above it: a quantile alone jumps if it falls between two
  // surfaces.
  float center = push.quantile * float(total), reach = max(0.5 * (float(total) - center), 0.5);
  float low = clamp(center - reach, 0.0, max(float(total) - 0.5, 0.0)), high = min(center + reach, float(total));
  float below = float(before);
  vec4 sum = vec4(0.0);  // of brightness, of the weight of white light, of its ln S
  for (uint i = first; i < end; ++i) {
    float above = below + float(LOAD(counts, i)), weight = float(LOAD(counts, kBrightnessBins + i));
    sum += vec4(max(min(above, high) - max(below, low), 0.0) * brightness_of(i), weight, weight * brightness_of(i), 0.0);
    below = above;
    STORE(counts, i, 0u);
    STORE(counts, kBrightnessBins + i, 0u);
  }
  sum = workgroup_sum(sum);
  if (lane > 0u) return;
  vec4 goal = vec4(-sum.x / (high - low), 1.0, sum.y > 0.0 ? sum.z / sum.y : 0.0, 0.0);
  STORE(target, 0, total == 0u ? vec4(0.0) : goal);
}
