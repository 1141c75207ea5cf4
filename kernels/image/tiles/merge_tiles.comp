// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"

// Flags the tiles that others flag, and those beside them. One tile an invocation.
WORD_IN(0, others);
WORD_INOUT(1, flags);
layout(push_constant) uniform Push { uvec2 tiles; } push;

void main() {
  uvec2 tile = grid_position(push.tiles.x);
  if (tile.y >= push.tiles.y) return;
  ivec2 first = max(ivec2(tile) - 1, ivec2(0)), last = min(ivec2(tile) + 1, ivec2(push.tiles) - 1);
  uint flagged = 0u;
  for (int y = first.y; y <= last.y; ++y)
    for (int x = first.x; x <= last.x; ++x) flagged |= FETCH1(others, y * int(push.tiles.x) + x);
  if (flagged != 0u) STORE(flags, tile.y * push.tiles.x + tile.x, 1u);
}
