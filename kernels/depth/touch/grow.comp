// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "touch.glsl"

// What may be in front is, if the surface of something that is goes on to it (hysteresis, as of Canny's edges). One pixel an invocation.
WORD_IN(0, kinds);
PLANE_IN(1, surface);  // of the frame: w: depth
WORD_OUT(2, grown);
layout(push_constant) uniform Push { uvec2 size; } push;

const int kReach = 2;               // pixels, past those that have no depth
const float kStep = 0.02;  // meters of depth, to the next

void main() {
  uint line = line_index();
  ivec2 pixel = ivec2(line % push.size.x, line / push.size.x), last = ivec2(push.size) - 1;
  if (pixel.y > last.y) return;
  uint kind = FETCH1(kinds, int(line));
  bool joins = false;
  if ((kind & (TOUCH_FRONT | TOUCH_MAYBE)) == TOUCH_MAYBE) {
    float z = FETCH(surface, int(line)).w;
    for (int y = max(pixel.y - kReach, 0); y <= min(pixel.y + kReach, last.y); ++y)
      for (int x = max(pixel.x - kReach, 0); x <= min(pixel.x + kReach, last.x); ++x) {
        int from = y * int(push.size.x) + x;
        joins = joins || ((FETCH1(kinds, from) & TOUCH_FRONT) != 0u && abs(FETCH(surface, from).w - z) < kStep);
      }
  }
  STORE(grown, line, joins ? kind | TOUCH_FRONT : kind);
}
