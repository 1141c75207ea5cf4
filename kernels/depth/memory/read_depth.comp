// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Meters of a depth image of 16 bits, two pixels a word; 0 and 65535 are unknown. One pixel an invocation.
WORD_IN(0, image);
SCALAR_OUT(1, depth);  // 0: unknown
layout(push_constant) uniform Push {
  uint pixels;
  float unit;  // meters of a step
} push;

void main() {
  uint at = line_index();
  if (at >= push.pixels) return;
  uint steps = FETCH1(image, int(at / 2u)) >> (16u * (at & 1u)) & 0xffffu;
  STORE(depth, at, steps == 0xffffu ? 0.0 : float(steps) * push.unit);
}
