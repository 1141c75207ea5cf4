// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/guide/guide.glsl"
#include "image/pack4.glsl"
#include "temporal.glsl"

// Mismatch of every cell with the frame before: squared differences, in units of those that halve the anchor, of its local
// contrast, its chroma (weighted low in dark cells), and the variance of its pixels' change, which an even change of light does not
// affect. And the share of its structure, the variance of its pixels in both frames, that has moved. One cell an invocation.
PLANE_IN(0, cells);
PLANE_IN(1, guide_coarse);
PLANE_IN(2, level0);
PLANE_IN(3, before);  // cell_state
PLANE_IN(4, memory);  // of packs of pixels
PLANE_OUT(5, mismatch);  // difference, structure that moved, structure, -
layout(push_constant) uniform Push {
  uvec2 size;  // of level 0
  float detail;
  float chroma;
  float texture;
} push;

const float kLittleLight = 0.02;
const float kLittleStructure = 0.02;

float variance(float sum, float squares, float share) {
  sum *= share;
  return max(share * squares - sum * sum, 0.0);
}

void main() {
  uvec2 cell_size = ((push.size + 1u) / 2u + 1u) / 2u, cell = grid_position(cell_size.x);
  if (cell.y >= cell_size.y) return;
  uvec2 first = 4u * cell, count = min(push.size - first, uvec2(4u));
  vec3 sum = vec3(0.0), squares = vec3(0.0);  // of the change, this frame and the one before
  float share = 1.0 / float(count.x * count.y);
  for (uint y = first.y; y < first.y + count.y; ++y) {
    vec4 was = FETCH(memory, int(MEMORY_STRIDE * (y * cell_size.x + cell.x)) + MEMORY_MEAN);
    for (uint x = 0u; x < count.x; ++x) {
      float m = FETCH(level0, int(y * push.size.x + first.x + x)).x;
      vec3 values = vec3(m - was.x, m, was.x);
      was = was.yzwx;
      sum += values;
      squares += values * values;
    }
  }
  uint at = cell.y * cell_size.x + cell.x;
  vec4 around = FETCH(guide_coarse, int((cell.y / 4u) * PACK4(cell_size.x) + cell.x / 4u)), guide = FETCH(cells, int(CELL_STRIDE * at));
  vec4 step = cell_state(guide, around) - FETCH(before, int(at));
  float light = exp(guide.x), confidence = light / (light + kLittleLight), change_variance = variance(sum.x, squares.x, share);
  float structure = variance(sum.y, squares.y, share) + variance(sum.z, squares.z, share);
  float counts = structure / (structure + kLittleStructure);
  vec3 differences = vec3(step.x * step.x, dot(step.yz, step.yz), change_variance);
  vec3 units = vec3(push.detail, push.chroma * confidence, push.texture);
  STORE(mismatch, at, vec4(dot(differences, units * units), counts * change_variance, counts * structure, 0.0));
}
