#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "guide.glsl"
#include "quad.glsl"
#include "temporal.glsl"

// How far a frame differs from the one before: the mean of q / (1 + q) over cells of 8 x 8 pixels, and its sum over the
// frame. One cell an invocation.
PLANE_IN(0, level0);
PLANE_IN(1, cells);
PLANE_IN(2, before);
SCALAR_OUT(3, blocks);
PLANE_OUT(4, sums);
layout(push_constant) uniform Push {
  uvec2 size;
  float detail;
  float chroma;
} push;

void main() {
  uvec2 block_size = (push.size + 7u) / 8u, block = grid_position(block_size.x);
  uint cell_columns = QUADS(push.size.x);
  float sum = 0.0;
  if (block.y < block_size.y) {
    uvec2 first = 8u * block, count = min(push.size - first, uvec2(8u));
    for (uint y = 0u; y < count.y; ++y)
      for (uint x = 0u; x < count.x; ++x) {
        uvec2 at = first + uvec2(x, y);
        int pixel = int(at.y * push.size.x + at.x);
        float cell_mean = FETCH(cells, int(CELL_STRIDE * ((at.y / 4u) * cell_columns + at.x / 4u))).x;
        float q = mismatch(FETCH(level0, pixel), cell_mean, FETCH(before, pixel), Change(push.detail, push.chroma));
        sum += q / (1.0 + q);
      }
    STORE(blocks, block.y * block_size.x + block.x, sum / float(count.x * count.y));
  }
  SUM_PARTIALS(sums, vec4(sum, 0.0, 0.0, 0.0));
}
