// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// One quarter of a mosaic: a plane at half size, each pixel the mean of 2x2.
PLANE_IN(0, picture);
PLANE_OUT(1, target);
layout(push_constant) uniform Push {
  uvec2 size;    // of both planes
  uvec2 origin;  // of the tile in the target
  uvec2 tile;    // its size
  uint shading;  // 1: draw w as gray
  float gain;  // 0: black, whatever the image holds
  uint first_row;
} push;

void main() {
  uvec2 at = gl_GlobalInvocationID.xy + uvec2(0u, push.first_row - push.origin.y);
  if (any(greaterThanEqual(at, push.tile))) return;  // rows before the first wrap around
  uvec2 first = at * 2u;
  uvec2 last = min(first + 1u, push.size - 1u);
  uint top = first.y * push.size.x;
  uint bottom = last.y * push.size.x;
  vec4 sum = FETCH(picture, int(top + first.x)) + FETCH(picture, int(top + last.x)) +
             FETCH(picture, int(bottom + first.x)) + FETCH(picture, int(bottom + last.x));
  vec3 color = (push.shading != 0u ? sum.www : sum.rgb) * (0.25 * push.gain);
  if (push.gain == 0.0) color = vec3(0.0);
  uvec2 to = at + push.origin;
  STORE(target, BY_ROWS(to.y * push.size.x + to.x), vec4(color, 1.0));
}
