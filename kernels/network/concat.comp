// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "value.glsl"

// Concatenates the channels of two images: one block of one pixel per invocation.
PLANE_IN(0, first);
PLANE_IN(1, second);
PLANE_OUT(2, result);
layout(push_constant) uniform Push {
  int area;  // pixels
  int first_channels, channels;
} push;

void main() {
  int item = int(line_index()), block = item / push.area, pixel = item - block * push.area;
  if (4 * block >= push.channels) return;
  vec4 v = vec4(0.0);
  for (int c = 0; c < 4; ++c) {
    int channel = 4 * block + c, behind = channel - push.first_channels;
    if (channel < push.first_channels)
      v[c] = FETCH(first, 1 + (channel / 4) * push.area + pixel)[channel % 4];
    else if (channel < push.channels)
      v[c] = FETCH(second, 1 + (behind / 4) * push.area + pixel)[behind % 4];
  }
  STORE(result, 1 + item, v);
}
