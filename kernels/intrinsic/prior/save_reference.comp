// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"
#include "intrinsic/guide/guide.glsl"

// Saves the guide that the edges of listed tiles are evaluated on, and if all tiles are listed the frame's statistics. One cell of
// guide level 1 an invocation.
PLANE_IN(0, level1);
PLANE_IN(1, statistics);
PLANE_OUT(2, kept);
PLANE_OUT(3, kept_statistics);
#define TILE_CONSTANT 1
#define TILE_BINDING 4
#include "image/tiles/tile_position.glsl"
layout(push_constant) uniform Push {
  uvec2 size;  // of level 1
  uint tiles;  // of the frame
} push;

void main() {
  uvec2 at = tile_position(push.size.x);
  if (at.y >= push.size.y) return;
  uint to = at.y * push.size.x + at.x;
  STORE(kept, to, FETCH(level1, int(to)));
  if (to == 0u && FETCH1(list, LIST_COUNT) == push.tiles) {
    for (int k = 0; k < STATISTICS_SIZE; ++k) STORE(kept_statistics, uint(k), FETCH(statistics, k));
  }
}
