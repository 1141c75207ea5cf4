// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "global/model/model.glsl"

// The residual as a slowly varying part of itself (a guided filter of itself, each component alone, weighted by confidence), in
// three passes over windows of the grid: the weighted mean; variance and mean around each point, and from them slope and
// offset; their means. One point an invocation.
layout(constant_id = 1) const uint kPass = 0u;
PLANE_IN(0, raw);     // residual, confidence
PLANE_IN(1, before);  // of the pass before
PLANE_OUT(2, after);  // smooth residual, weighted residual | slope, offset | the same, of means
layout(push_constant) uniform Push {
  ivec2 grid;
  int radius;
  float edge;  // variance that counts as an edge
} push;

const float kMinConfidence = 0.05;  // of a window's points

void main() {
  int i = int(line_index());
  if (i >= push.grid.x * push.grid.y) return;
  ivec2 at = ivec2(i % push.grid.x, i / push.grid.x);
  ivec2 low = max(at - push.radius, 0), high = min(at + push.radius, push.grid - 1);
  vec4 sum = vec4(0.0);
  float weights = 0.0, points = 0.0;
  for (int y = low.y; y <= high.y; ++y)
    for (int x = low.x; x <= high.x; ++x) {
      int n = y * push.grid.x + x;
      vec4 own = FETCH(raw, n);
      weights += own.z;
      if (kPass == 0u) {
        sum += own.z * own;
        points += 1.0;
      } else if (kPass == 1u) {
        vec2 e = FETCH(before, n).zw;
        sum += own.z * vec4(e, e * e);
      } else {
        sum += own.z * FETCH(before, n);
      }
    }
  if (kPass == 0u) {
    vec4 own = FETCH(raw, i);
    vec2 smooth_part = sum.xy / (weights + kMinConfidence * points);
    STORE(after, i, vec4(smooth_part, mix(smooth_part, own.xy, own.z)));
  } else if (kPass == 1u) {
    sum /= weights + 1e-6;
    vec2 variance = max(sum.zw - sum.xy * sum.xy, vec2(0.0)), slope = variance / (variance + push.edge);
    STORE(after, i, vec4(slope, (1.0 - slope) * sum.xy));
  } else {
    STORE(after, i, sum / (weights + 1e-6));
  }
}
