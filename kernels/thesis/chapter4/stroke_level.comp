// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"

// Strokes of a level (strokes.glsl) from those of the finer one: a coarse pixel belongs to the stroke that has most of the weight of the
// 3 x 3 fine pixels around its own, by (1 2 1)/4 along each axis, with that weight. One pack of pixels an invocation.
PLANE_IN(0, fine);
PLANE_OUT(1, coarse);
layout(push_constant) uniform Push {
  uvec2 size;
  uvec2 fine_size;
} push;

float fine_at(ivec2 at) {
  uvec2 p = uvec2(clamp(at, ivec2(0), ivec2(push.fine_size) - 1));
  return FETCH(fine, int(p.y * PACK4(push.fine_size.x) + p.x / 4u))[p.x & 3u];
}

float coarse_at(ivec2 at) {
  float near[9];
  for (int k = 0; k < 9; ++k) near[k] = fine_at(2 * at + ivec2(k % 3, k / 3) - 1);
  float number = 0.0, most = 0.0;
  for (int k = 0; k < 9; ++k) {
    float sum = 0.0;
    for (int j = 0; j < 9; ++j)
      sum += floor(near[j]) == floor(near[k]) ? float((2 - abs(j % 3 - 1)) * (2 - abs(j / 3 - 1))) / 16.0 * 2.0 * fract(near[j]) : 0.0;
    if (sum <= most) continue;
    most = sum;
    number = floor(near[k]);
  }
  return number + 0.5 * most;
}

void main() {
  uint packs = PACK4(push.size.x);
  uvec2 position = grid_position(packs);
  if (position.y >= push.size.y) return;
  vec4 mask;
  for (uint k = 0u; k < 4u; ++k) mask[k] = coarse_at(ivec2(4u * position.x + k, position.y));
  STORE(coarse, position.y * packs + position.x, MASKED(mask, INSIDE(position.x, push.size.x)));
}
