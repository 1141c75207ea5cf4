#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "guide.glsl"
#include "quad.glsl"
#include "temporal.glsl"

// How far a frame differs from the one before: the mean of q / (1 + q) over tiles of 4 x 4 cells (the cells of guide
// level 4), and its sum over the frame. One tile an invocation.
PLANE_IN(0, cells);
PLANE_IN(1, wide);
PLANE_IN(2, before);
SCALAR_OUT(3, tiles);
PLANE_OUT(4, sums);
layout(push_constant) uniform Push {
  uvec2 size;  // of level 2
  float detail;
  float chroma;
} push;

void main() {
  uvec2 tile_size = (push.size + 3u) / 4u, tile = grid_position(tile_size.x);
  float sum = 0.0;
  if (tile.y < tile_size.y) {
    uvec2 first = 4u * tile, count = min(push.size - first, uvec2(4u));
    uint to = tile.y * tile_size.x + tile.x;
    vec4 around = FETCH(wide, int(to));
    for (uint y = first.y; y < first.y + count.y; ++y)
      for (uint x = first.x; x < first.x + count.x; ++x) {
        int cell = int(y * push.size.x + x);
        float q = mismatch(cell_state(FETCH(cells, CELL_STRIDE * cell), around), FETCH(before, cell), push.detail,
                           push.chroma);
        sum += q / (1.0 + q);
      }
    STORE(tiles, to, sum / float(count.x * count.y));
  }
  SUM_PARTIALS(sums, vec4(sum, 0.0, 0.0, 0.0));
}
