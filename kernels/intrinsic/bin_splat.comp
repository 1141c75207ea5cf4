#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"
#include "guide.glsl"
#include "bins.glsl"

// Adds every cell to the four bins around its chroma: with kWeights its weight g, else g r at the present solution,
// r = m' - s' - (correction of s'). One quad of cells an invocation.
layout(constant_id = 1) const bool kWeights = false;
PLANE_IN(0, cells);
PLANE_IN(1, terms);
PLANE_IN(2, mean);        // s'
PLANE_IN(3, correction);
WORD_INOUT(4, sums);      // kBins x kBins, signed fixed point, starts at 0
layout(push_constant) uniform Push {
  uvec2 size;  // of level 2
  float scale;
} push;

void main() {
  uint quads = QUADS(push.size.x);
  uvec2 position = grid_position(quads);
  if (position.y >= push.size.y) return;
  int at = int(position.y * quads + position.x);
  vec4 part = push.scale * FETCH(terms, TERMS_STRIDE * at + TERMS_CHROMA);
  if (!kWeights) {
    vec4 r = FETCH(terms, TERMS_STRIDE * at + TERMS_MEAN) - FETCH(mean, at) - FETCH(correction, at);
    part *= clamp(r / kMostReflectance, -1.0, 1.0);
  }
  uint count = min(push.size.x - 4u * position.x, 4u);
  for (uint k = 0u; k < count; ++k) {
    vec2 fraction, chroma = FETCH(cells, int(CELL_STRIDE * (position.y * push.size.x + 4u * position.x + k))).yz;
    uvec2 bin = bin_of(chroma, fraction);
    ivec4 shares = ivec4(round(hats(fraction) * part.x));
    uint to = bin.y * uint(kBins) + bin.x;
    atomicAdd(LOAD(sums, to), uint(shares.x));
    atomicAdd(LOAD(sums, to + 1u), uint(shares.y));
    atomicAdd(LOAD(sums, to + uint(kBins)), uint(shares.z));
    atomicAdd(LOAD(sums, to + uint(kBins) + 1u), uint(shares.w));
    part = part.yzwx;
  }
}
