#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"
#include "bins.glsl"

// Adds every 4 x 4 cell's weighted reflectance, sum g (m - s), to the four bins around its chroma. One cell an
// invocation.
PLANE_IN(0, sums);
PLANE_IN(1, value);
PLANE_IN(2, shading);
WORD_INOUT(3, totals);  // kBins x kBins signed fixed point, starts at 0
layout(push_constant) uniform Push {
  uvec2 size;
  float scale;
} push;

void main() {
  uint quads = QUADS(push.size.x);
  uvec2 cell = grid_position(quads);
  uint first = 4u * cell.y;
  if (first >= push.size.y) return;
  vec4 sum = FETCH(sums, int(cell.y * quads + cell.x));
  float total = sum.w;
  for (uint y = first; y < min(first + 4u, push.size.y); ++y) {
    int at = int(y * quads + cell.x);
    total -= dot(FETCH(value, VALUE_STRIDE * at + VALUE_CHROMA), FETCH(shading, at));
  }
  vec2 fraction;
  uvec2 bin = bin_of(sum.xy, fraction);
  total = clamp(total, -kMostReflectance * sum.z, kMostReflectance * sum.z) * (push.scale / kMostReflectance);
  ivec4 parts = ivec4(round(hats(fraction) * total));
  uint to = bin.y * uint(kBins) + bin.x;
  atomicAdd(LOAD(totals, to), uint(parts.x));
  atomicAdd(LOAD(totals, to + 1u), uint(parts.y));
  atomicAdd(LOAD(totals, to + uint(kBins)), uint(parts.z));
  atomicAdd(LOAD(totals, to + uint(kBins) + 1u), uint(parts.w));
}
