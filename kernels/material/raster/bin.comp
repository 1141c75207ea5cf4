// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Marks the groups of triangles that may be visible in each tile: one bit per group, 32 groups per word, words of a
// tile adjacent.
PLANE_IN(0, boxes);
WORD_OUT(1, bits);
layout(push_constant) uniform Push {
  uint columns;         // tiles along a row
  uint tile;            // pixels along a tile
  uint groups, words;   // words a tile
} push;

void main() {
  uvec2 at = gl_GlobalInvocationID.xy;  // a word of a row of tiles
  if (at.x >= push.columns * push.words) return;
  uint column = at.x / push.words, first = (at.x - column * push.words) * 32u;
  vec2 low = vec2(column, at.y) * float(push.tile), high = low + float(push.tile);
  uint word = 0u;
  for (uint k = 0u; k < min(32u, push.groups - first); ++k) {
    vec4 box = FETCH(boxes, int(first + k));
    bool meets = all(lessThan(box.xy, high)) && all(greaterThan(box.zw, low));
    word |= meets ? 1u << k : 0u;
  }
  STORE(bits, at.y * push.columns * push.words + at.x, word);
}
