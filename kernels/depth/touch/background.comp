// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "touch.glsl"

// Takes the depth away of what is in front of the scene and reaches into the picture, and of two pixels around it; what else is in front
// is the scene where it was hidden. One pixel an invocation.
WORD_IN(0, kinds);
WORD_IN(1, arm);
SCALAR_INOUT(2, depth);
layout(push_constant) uniform Push { uvec2 size; } push;

const int kAround = 2;

void main() {
  uint line = line_index();
  ivec2 pixel = ivec2(line % push.size.x, line / push.size.x), last = ivec2(push.size) - 1;
  if (pixel.y > last.y) return;
  uint tile = uint(pixel.y) / TOUCH_TILE * ((push.size.x + TOUCH_TILE - 1u) / TOUCH_TILE) + uint(pixel.x) / TOUCH_TILE;
  if (tile < 32u * TOUCH_ARM_WORDS && (FETCH1(arm, int(tile >> 5)) >> (tile & 31u) & 1u) == 0u) return;
  bool front = false;
  for (int y = max(pixel.y - kAround, 0); y <= min(pixel.y + kAround, last.y); ++y)
    for (int x = max(pixel.x - kAround, 0); x <= min(pixel.x + kAround, last.x); ++x)
      front = front || (FETCH1(kinds, y * int(push.size.x) + x) & TOUCH_FRONT) != 0u;
  if (front) STORE(depth, line, 0.0);
}
