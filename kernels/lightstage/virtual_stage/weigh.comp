// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// A frame by superposition: total (+)= sum over listed lights of color · OLAT image.
WORD_IN(0, olats);    // half floats, two words a pixel, image after image
PLANE_IN(1, colors);  // rgb; w = place of the light's image
PLANE_INOUT(2, total);
layout(push_constant) uniform Push {
  uint pixels;
  uint first, count;  // of the list
  uint add;           // to what is there, or 0
} push;

void main() {
  uint i = line_index();
  if (i >= push.pixels) return;
  vec3 sum = push.add != 0u ? LOAD(total, i).rgb : vec3(0.0);
  for (uint k = push.first; k < push.first + push.count; ++k) {
    vec4 color = FETCH(colors, int(k));
    int at = 2 * (int(color.w) * int(push.pixels) + int(i));
    vec2 rg = unpackHalf2x16(FETCH1(olats, at)), b = unpackHalf2x16(FETCH1(olats, at + 1));
    sum += color.rgb * vec3(rg, b.x);
  }
  STORE(total, i, vec4(sum, 1.0));
}
