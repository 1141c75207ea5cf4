// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "gpu/common.glsl"
#include "fields.glsl"
#include "image/pack4.glsl"

// The fields of fields.glsl from the output of PriorNetwork: channel 4 q + 2 (y & 1) + (x & 1) is field q of pixel (x, y), within
// its limits. 2 x 2 pixels, one of the output, an invocation.
PLANE_IN(0, prior);
PLANE_OUT(1, fields);
layout(push_constant) uniform Push {
  ivec2 size;  // of the network's picture
  ivec2 half_padded;
} push;

const float kLimit = 5.0;  // of the fields, after saturation
const float kHuge = 1e30;

// x / (1 + |x| / kLimit). NaN counts as 0.
vec4 saturated(vec4 x) {
  bvec4 wrong = greaterThan(floatBitsToInt(x) & ivec4(0x7fffffff), ivec4(0x7f800000));
  x = clamp(mix(x, vec4(0.0), wrong), -kHuge, kHuge);
  return x / (1.0 + abs(x) / kLimit);
}

void main() {
  ivec2 position = ivec2(grid_position(uint(push.size.x + 1) / 2u));
  if (2 * position.y >= push.size.y) return;
  int area = push.half_padded.x * push.half_padded.y, from = 1 + position.y * push.half_padded.x + position.x;
  vec4 field[FIELDS];  // at the four pixels
  [[unroll]] for (int q = 0; q < FIELDS; ++q) field[q] = FETCH(prior, from + q * area);
  [[unroll]] for (int k = 0; k < 4; ++k) {
    ivec2 at = 2 * position + ivec2(k & 1, k >> 1);
    if (any(greaterThanEqual(at, push.size))) continue;
    STORE(fields, at.y * push.size.x + at.x, saturated(vec4(field[0][k], field[1][k], field[2][k], 0.0)));
  }
}
