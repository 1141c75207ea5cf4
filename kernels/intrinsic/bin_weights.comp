#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"
#include "guide.glsl"
#include "bins.glsl"

// What of the chroma bins stays the same for a whole frame: the weight of every bin, and every 4 x 4 cell's own sums of g
// and g m. One cell of guide level 2 an invocation.
PLANE_IN(0, level0);
PLANE_IN(1, cells);
PLANE_IN(2, value);
WORD_INOUT(3, weights);  // kBins x kBins, starts at 0
PLANE_OUT(4, sums);      // a cell: c0, c1, sum g, sum g m
layout(push_constant) uniform Push {
  uvec2 size;
  float scale;
} push;

void main() {
  uint quads = QUADS(push.size.x);
  uvec2 cell = grid_position(quads);
  uint first = 4u * cell.y;
  if (first >= push.size.y) return;
  float weight = 0.0, light = 0.0;
  for (uint y = first; y < min(first + 4u, push.size.y); ++y) {
    vec4 g = FETCH(value, int(VALUE_STRIDE * (y * quads + cell.x) + VALUE_CHROMA));
    uint row = y * push.size.x, last = push.size.x - 1u, x = 4u * cell.x;
    vec4 m = vec4(FETCH(level0, int(row + x)).x, FETCH(level0, int(row + min(x + 1u, last))).x,
                  FETCH(level0, int(row + min(x + 2u, last))).x, FETCH(level0, int(row + min(x + 3u, last))).x);
    weight += dot(g, vec4(1.0));
    light += dot(g, m);
  }
  uint at = cell.y * quads + cell.x;
  vec2 chroma = FETCH(cells, int(CELL_STRIDE * at)).yz, fraction;
  STORE(sums, at, vec4(chroma, weight, light));
  uvec2 bin = bin_of(chroma, fraction);
  uvec4 parts = uvec4(hats(fraction) * weight * push.scale + 0.5);
  uint to = bin.y * uint(kBins) + bin.x;
  atomicAdd(LOAD(weights, to), parts.x);
  atomicAdd(LOAD(weights, to + 1u), parts.y);
  atomicAdd(LOAD(weights, to + uint(kBins)), parts.z);
  atomicAdd(LOAD(weights, to + uint(kBins) + 1u), parts.w);
}
