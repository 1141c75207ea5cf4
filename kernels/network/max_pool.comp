// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "value.glsl"

// Maximum of every 2 x 2 pixels, channel by channel.
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
  int at = 1 + (block * push.source.y + 2 * y) * push.source.x + 2 * x;
  vec4 top = max(FETCH(image, at), FETCH(image, at + 1));
  at += push.source.x;
  STORE(result, 1 + item, max(top, max(FETCH(image, at), FETCH(image, at + 1))));
}
