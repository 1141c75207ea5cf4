// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "value.glsl"

// Doubles the size, bilinear: pixel centers at halves, clamped at the border.
PLANE_IN(0, image);
PLANE_OUT(1, result);
layout(push_constant) uniform Push {
  ivec2 size;    // of the result
  ivec2 source;  // of the image
  int blocks;
} push;

void main() {
  int item = int(line_index()), x = item % push.size.x, row = item / push.size.x;
  if (row >= push.size.y * push.blocks) return;
  int block = row / push.size.y, y = row - block * push.size.y;
  ivec2 second = (ivec2(x, y) + 1) / 2;
  ivec2 low = clamp(second - 1, ivec2(0), push.source - 1), high = clamp(second, ivec2(0), push.source - 1);
  vec2 share = mix(vec2(0.25), vec2(0.75), equal(ivec2(x, y) & 1, ivec2(0)));
  int start = 1 + block * push.source.x * push.source.y;
  int top = start + low.y * push.source.x, bottom = start + high.y * push.source.x;
  STORE(result, 1 + item,
        mix(mix(FETCH(image, top + low.x), FETCH(image, top + high.x), share.x),
            mix(FETCH(image, bottom + low.x), FETCH(image, bottom + high.x), share.x), share.y));
}
