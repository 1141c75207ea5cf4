// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "value.glsl"

// Softmax over the channels, one pixel per invocation; the maximum is subtracted first, against overflow.
PLANE_IN(0, image);
PLANE_OUT(1, result);
layout(push_constant) uniform Push { int area, channels; } push;

float component_max(vec4 v) { return max(max(v.r, v.g), max(v.b, v.a)); }

// Channels that exist; others count as `else_`.
vec4 present(vec4 v, int block, float else_) {
  return mix(vec4(else_), v, lessThan(4 * block + ivec4(0, 1, 2, 3), ivec4(push.channels)));
}

void main() {
  int pixel = int(line_index()), blocks = (push.channels + 3) / 4;
  if (pixel >= push.area) return;
  float largest = FETCH(image, 1 + pixel).r, sum = 0.0;
  for (int i = 0; i < blocks; ++i)
    largest = max(largest, component_max(present(FETCH(image, 1 + i * push.area + pixel), i, largest)));
  for (int i = 0; i < blocks; ++i)
    sum += dot(vec4(1.0), present(exp(FETCH(image, 1 + i * push.area + pixel) - largest), i, 0.0));
  for (int i = 0; i < blocks; ++i)
    STORE(result, 1 + i * push.area + pixel, present(exp(FETCH(image, 1 + i * push.area + pixel) - largest), i, 0.0) / sum);
}
