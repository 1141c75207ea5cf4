// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Ln of the mean channel of a linear picture, blurred by (1 2 1)/4 along both sides: between pixels, what is sharp is not linear. One
// pixel an invocation.
PLANE_IN(0, picture);
SCALAR_OUT(1, brightness);
layout(push_constant) uniform Push { uvec2 size; } push;

float at(ivec2 pixel) {
  ivec2 p = clamp(pixel, ivec2(0), ivec2(push.size) - 1);
  return log(max(dot(FETCH(picture, p.y * int(push.size.x) + p.x).rgb, vec3(1.0 / 3.0)), 1e-3));
}

void main() {
  uint line = line_index();
  ivec2 pixel = ivec2(line % push.size.x, line / push.size.x);
  if (pixel.y >= int(push.size.y)) return;
  float sum = 0.0;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) sum += float((2 - abs(dx)) * (2 - abs(dy))) * at(pixel + ivec2(dx, dy));
  STORE(brightness, line, sum / 16.0);
}
