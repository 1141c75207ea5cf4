// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// One direction of two separable Gaussians, of which the second is kRatio times as wide. The border goes on beyond the frame.
layout(constant_id = 1) const bool DOWN = false;  // the second direction, along columns
SCALAR_IN(0, near);
SCALAR_IN(1, wide);  // DOWN only: before, both are the same
PLANE_IN(2, weights);  // of distance 0, 1 …: of the first Gaussian, of the second, -, -
SCALAR_OUT(3, near_blurred);
SCALAR_OUT(4, wide_blurred);
layout(push_constant) uniform Push {
  uvec2 size;
  int radius;
  uint first_row;
} push;

vec2 value_at(int n) {
  float value = FETCH1(near, n);
  return vec2(value, DOWN ? FETCH1(wide, n) : value);
}

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y);
  ivec2 size = ivec2(push.size);
  if (at.x >= size.x || at.y >= size.y) return;
  int row = at.y * size.x;
  vec2 sum = FETCH(weights, 0).xy * value_at(row + at.x);
  for (int k = 1; k <= push.radius; ++k) {
    vec2 before = value_at(DOWN ? max(at.y - k, 0) * size.x + at.x : row + max(at.x - k, 0));
    vec2 after = value_at(DOWN ? min(at.y + k, size.y - 1) * size.x + at.x : row + min(at.x + k, size.x - 1));
    sum += FETCH(weights, k).xy * (before + after);
  }
  STORE(near_blurred, BY_ROWS(row + at.x), sum.x);
  STORE(wide_blurred, BY_ROWS(row + at.x), sum.y);
}
