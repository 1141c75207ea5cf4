// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"

// Flags the tiles whose picture differs if the flagged ones do: those themselves and, as chroma is averaged with pixels to
// the left and above, those to the right and below. One tile an invocation.
WORD_IN(0, flags);
WORD_OUT(1, drawn);
layout(push_constant) uniform Push { uvec2 tiles; } push;

void main() {
  uvec2 tile = grid_position(push.tiles.x);
  if (tile.y >= push.tiles.y) return;
  uvec2 before = max(tile, uvec2(1u)) - 1u;
  int row = int(tile.y * push.tiles.x), above = int(before.y * push.tiles.x);
  uint any = FETCH1(flags, row + int(tile.x)) | FETCH1(flags, row + int(before.x)) | FETCH1(flags, above + int(tile.x)) |
             FETCH1(flags, above + int(before.x));
  STORE(drawn, uint(row) + tile.x, any);
}
