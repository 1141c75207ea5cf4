// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"

// Flags the flagged tiles and those beside them: of solutions, which share edges with all eight neighbors; of pictures (kDrawn) those
// to the right and below only, as chroma is averaged with pixels to the left and above. One tile an invocation.
layout(constant_id = 1) const bool kDrawn = false;
WORD_IN(0, flags);
WORD_OUT(1, dilated);
layout(push_constant) uniform Push { uvec2 tiles; } push;

void main() {
  uvec2 tile = grid_position(push.tiles.x);
  if (tile.y >= push.tiles.y) return;
  uvec2 first = max(tile, uvec2(1u)) - 1u, last = kDrawn ? tile : min(tile + 1u, push.tiles - 1u);
  uint any = 0u;
  for (uint y = first.y; y <= last.y; ++y)
    for (uint x = first.x; x <= last.x; ++x) any |= FETCH1(flags, int(y * push.tiles.x + x));
  STORE(dilated, tile.y * push.tiles.x + tile.x, any);
}
