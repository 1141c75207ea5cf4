// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "object.glsl"

// Blocks of cells with a part of the object; adds up its area, center and bounds.
WORD_IN(0, region);
WORD_OUT(1, occupied);
WORD_INOUT(2, status);  // zero before
layout(push_constant) uniform Push {
  uvec2 cells;
  uvec2 blocks;
} push;

void main() {
  uvec2 block = gl_GlobalInvocationID.xy;
  if (block.x >= push.blocks.x) return;
  uvec2 first = block * uint(kCoarse), last = min(first + uint(kCoarse), push.cells);
  uint area = 0u;
  uvec2 sum = uvec2(0u), low = uvec2(0xffffffffu), high = uvec2(0u);
  for (uint y = first.y; y < last.y; ++y)
    for (uint x = first.x; x < last.x; ++x)
      if (FETCH1(region, int(y * push.cells.x + x)) != 0u) {
        ++area;
        sum += uvec2(x, y);
        low = min(low, uvec2(x, y));
        high = max(high, uvec2(x, y) + 1u);
      }
  STORE(occupied, block.y * push.blocks.x + block.x, area > 0u ? 1u : 0u);
  if (area == 0u) return;
  atomicAdd(LOAD(status, kArea), area);
  atomicAdd(LOAD(status, kSumX), sum.x);
  atomicAdd(LOAD(status, kSumY), sum.y);
  atomicMax(LOAD(status, kLeft), push.cells.x - low.x);
  atomicMax(LOAD(status, kTop), push.cells.y - low.y);
  atomicMax(LOAD(status, kRight), high.x);
  atomicMax(LOAD(status, kBottom), high.y);
}
