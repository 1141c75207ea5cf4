// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"
#include "upsample.glsl"

// The line (a, b) of every half-size pixel. One an invocation.
PLANE_IN(0, samples);
PLANE_OUT(1, lines);
layout(push_constant) uniform Push {
  uvec2 size;  // of the half-size frame
  uint first_row;
} push;

void main() {
  uvec2 at = grid_position(push.size.x) + uvec2(0u, push.first_row);
  if (at.y >= push.size.y) return;
  int pixel = int(at.y * push.size.x + at.x);
  vec2 origin = FETCH(samples, pixel).xy, sum = vec2(0.0), products = vec2(0.0);
  for (int dy = -1; dy <= 1; ++dy) {
    int row = clamp(int(at.y) + dy, 0, int(push.size.y) - 1) * int(push.size.x);
    for (int dx = -1; dx <= 1; ++dx) {
      vec2 d = FETCH(samples, row + clamp(int(at.x) + dx, 0, int(push.size.x) - 1)).xy - origin;
      sum += d;
      products += d.x * d;
    }
  }
  vec2 mean = sum / 9.0, spread = products / 9.0 - mean.x * mean;
  float a = clamp(spread.y / (max(spread.x, 0.0) + kFlatVariance), 0.0, 1.0);
  STORE(lines, BY_ROWS(pixel), vec4(a, mean.y + origin.y - a * (mean.x + origin.x), 0.0, 0.0));
}
