// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "object.glsl"

// Blocks near the object: within .4 of its size, the root of its area, and at least .02 of the frame's diagonal. Colors there may
// be its own that are not recognized yet.
WORD_IN(0, occupied);
WORD_IN(1, status);
WORD_OUT(2, near);
WORD_OUT(3, last_area);
layout(push_constant) uniform Push {
  ivec2 blocks;
  float min_reach;  // cells
} push;

void main() {
  ivec2 block = ivec2(gl_GlobalInvocationID.xy);
  if (block.x >= push.blocks.x) return;
  uint area = FETCH1(status, kArea);
  int reach = int(ceil(max(0.4 * sqrt(float(area)), push.min_reach) / float(kCoarse)));
  ivec2 first = max(block - reach, ivec2(0)), last = min(block + reach, push.blocks - 1);
  uint found = 0u;
  for (int y = first.y; y <= last.y && found == 0u; ++y)
    for (int x = first.x; x <= last.x; ++x) found |= FETCH1(occupied, y * push.blocks.x + x);
  STORE(near, block.y * push.blocks.x + block.x, found);
  if (block == ivec2(0) && area > 0u) STORE(last_area, 0, area);
}
