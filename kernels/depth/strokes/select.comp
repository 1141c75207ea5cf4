// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "brush.glsl"

// Lists the blocks that strokes may touch, and those whose marks may spread as voxels around them have a color now that had none.
// One block of the pool an invocation.
WORD_IN(0, table);
WORD_IN(1, keys);
WORD_IN(2, colored);
PLANE_IN(3, brushes);
WORD_IN(4, ids);
WORD_INOUT(5, marked);
WORD_INOUT(6, sums);
WORD_INOUT(7, state);
WORD_OUT(8, list);  // places of blocks, and LIST_SPREADS
layout(push_constant) uniform Push {
  uint table_mask;
  uint blocks;
  uint ids;
  uint brushes;
  float voxel;
  uint all;  // those with marks
} push;
#include "camera/find_block.glsl"

void main() {
  uint block = line_index();
  if (block < push.ids && (FETCH1(ids, int(block)) & ID_FRESH) != 0u)
    for (uint i = 0u; i < SUM_STRIDE; ++i) STORE(sums, SUM_STRIDE * block + i, 0u);
  if (block >= push.blocks) return;
  uint key = FETCH1(keys, int(block));
  if (key == kNoBlock) return;
  float side = float(kBlockSide) * push.voxel, radius = 0.5 * sqrt(3.0) * side;
  vec3 center = (vec3(block_of_key(key)) + 0.5) * side;
  uint before = LOAD(marked, block);
  bool spreads = false, touched = false;
  if (before != MARKED_NONE) {
    uint count = MARKED_COUNT;
    for (int i = 0; i < 27; ++i) {
      uint next = find_block(block_of_key(key) + ivec3(i % 3, i / 3 % 3, i / 9) - 1);
      count += next == kNoBlock ? 0u : FETCH1(colored, int(next));
    }
    spreads = push.all != 0u || before != count;
    STORE(marked, block, count);
  }
  for (uint i = 0u; i < push.brushes; ++i) {
    vec4 bound = FETCH(brushes, BRUSH_STRIDE * int(i) + BRUSH_BOUND);
    touched = touched || distance(center, bound.xyz) < radius + bound.w;
  }
  if (touched || spreads) STORE(list, atomicAdd(LOAD(state, STATE_BLOCKS), 1u), block | (spreads ? LIST_SPREADS : 0u));
}
