// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "value.glsl"

// A 1 x 1 convolution with bias and activation: PIXELS pixels of one block of channels per invocation. Weights as for 3
// x 3, with one tap.
#define PIXELS 8
PLANE_IN(0, image);
PLANE_IN(1, weights);
PLANE_OUT(2, result);
layout(push_constant) uniform Push {
  ivec2 size;    // of the result
  ivec2 source;  // of the image
  int source_blocks, blocks, stride;
  float slope;
} push;

void main() {
  int pixels = push.size.x * push.size.y, lanes = (pixels + PIXELS - 1) / PIXELS;
  int item = int(line_index()), lane = item % lanes, block = item / lanes;
  if (block >= push.blocks) return;
  vec4 sums[PIXELS];
  int from[PIXELS];
  for (int k = 0; k < PIXELS; ++k) {
    int pixel = lane + k * lanes, y = pixel / push.size.x, x = pixel - y * push.size.x;
    sums[k] = FETCH(weights, block);
    from[k] = pixel < pixels ? 1 + push.stride * (y * push.source.x + x) : 0;
  }
  int weight = push.blocks + 4 * block * push.source_blocks, area = push.source.x * push.source.y;
  for (int i = 0; i < push.source_blocks; ++i) {
    vec4 r = FETCH(weights, weight), g = FETCH(weights, weight + 1), b = FETCH(weights, weight + 2),
         a = FETCH(weights, weight + 3);
    weight += 4;
    for (int k = 0; k < PIXELS; ++k) {
      vec4 v = FETCH(image, from[k] + (from[k] > 0 ? i * area : 0));
      sums[k] += v.r * r + v.g * g + v.b * b + v.a * a;
    }
  }
  for (int k = 0; k < PIXELS; ++k)
    if (lane + k * lanes < pixels)
      STORE(result, 1 + block * pixels + lane + k * lanes, activated(sums[k], push.slope));
}
