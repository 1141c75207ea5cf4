// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"

// Of tiles of 4 x 4 cells (the cells of guide level 4): the mean of q / (1 + q), q the cells' difference from the frame before,
// and the sums of the structure that moved and of all structure. And the frame's sums. One tile an invocation.
PLANE_IN(0, mismatch);
PLANE_OUT(1, tiles);
PLANE_OUT(2, sums);
layout(push_constant) uniform Push { uvec2 size; } push;  // of level 2

void main() {
  uvec2 tile_size = (push.size + 3u) / 4u, tile = grid_position(tile_size.x);
  vec4 sum = vec4(0.0);
  if (tile.y < tile_size.y) {
    uvec2 first = 4u * tile, count = min(push.size - first, uvec2(4u));
    for (uint y = first.y; y < first.y + count.y; ++y)
      for (uint x = first.x; x < first.x + count.x; ++x) {
        vec4 q = FETCH(mismatch, int(y * push.size.x + x));
        sum += vec4(q.x / (1.0 + q.x), q.yz, 0.0);
      }
    STORE(tiles, tile.y * tile_size.x + tile.x, vec4(sum.x / float(count.x * count.y), sum.yz, 0.0));
  }
  SUM_PARTIALS(sums, sum);
}
