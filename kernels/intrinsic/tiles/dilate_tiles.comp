// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"

// Flags the tiles whose residual differs if the flagged ones are solved: those themselves and all beside them; and those whose picture
// does: themselves and, as chroma is averaged with pixels to the left and above, those to the right and below. One tile an invocation.
WORD_IN(0, flags);
WORD_OUT(1, around);
WORD_OUT(2, drawn);
layout(push_constant) uniform Push { uvec2 tiles; } push;

void main() {
  uvec2 tile = grid_position(push.tiles.x);
  if (tile.y >= push.tiles.y) return;
  uvec2 first = max(tile, uvec2(1u)) - 1u, last = min(tile + 1u, push.tiles - 1u);
  uint any = 0u, any_before = 0u;
  for (uint y = first.y; y <= last.y; ++y)
    for (uint x = first.x; x <= last.x; ++x) {
      uint flag = FETCH1(flags, int(y * push.tiles.x + x));
      any |= flag;
      if (x <= tile.x && y <= tile.y) any_before |= flag;
    }
  uint at = tile.y * push.tiles.x + tile.x;
  STORE(around, at, any);
  STORE(drawn, at, any_before);
}
