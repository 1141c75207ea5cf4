// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "value.glsl"

// A 3 x 3 convolution of every channel by itself, with zero padding, bias and activation. An invocation computes one
// pixel of one block of channels.
//
// Weights: [block] of bias, then [block][row][column], each a vec4 of the block's channels.
PLANE_IN(0, image);
PLANE_IN(1, weights);
PLANE_OUT(2, result);
layout(push_constant) uniform Push {
  ivec2 size;    // of the result
  ivec2 source;  // of the image
  int blocks, stride, dilation;
  float slope;
} push;

void main() {
  int item = int(line_index()), x = item % push.size.x, row = item / push.size.x;
  if (row >= push.size.y * push.blocks) return;
  int block = row / push.size.y, y = row - block * push.size.y;
  int start = 1 + block * push.source.x * push.source.y, weight = push.blocks + 9 * block;
  vec4 sum = FETCH(weights, block);
  for (int dy = -1; dy <= 1; ++dy) {
    int v = push.stride * y + push.dilation * dy;
    bool inside = v >= 0 && v < push.source.y;
    for (int dx = -1; dx <= 1; ++dx, ++weight) {
      int u = push.stride * x + push.dilation * dx;
      sum += FETCH(weights, weight) *
             FETCH(image, inside && u >= 0 && u < push.source.x ? start + v * push.source.x + u : 0);
    }
  }
  STORE(result, 1 + item, activated(sum, push.slope));
}
