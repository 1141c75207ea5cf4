// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// A plane in another size: the mean of 4 x 4 points of the part that a pixel shows. One pixel an invocation.
PLANE_IN(0, plane);
PLANE_OUT(1, resized);
layout(push_constant) uniform Push {
  uvec2 from;
  uvec2 to;
} push;

void main() {
  uint line = line_index();
  uvec2 pixel = uvec2(line % push.to.x, line / push.to.x);
  if (pixel.y >= push.to.y) return;
  vec4 sum = vec4(0.0);
  for (uint y = 0u; y < 4u; ++y)
    for (uint x = 0u; x < 4u; ++x) {
      uvec2 at = min((8u * pixel + 2u * uvec2(x, y) + 1u) * push.from / (8u * push.to), push.from - 1u);
      sum += FETCH(plane, int(at.y * push.from.x + at.x));
    }
  STORE(resized, line, sum / 16.0);
}
