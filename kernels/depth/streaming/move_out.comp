// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/blocks.glsl"
#include "depth/state.glsl"
#include "moves.glsl"

// Copies blocks that leave, and gives their places back. Their entries of the hash table stay: insert.comp makes it anew. A workgroup of
// 64 a block.
WORD_IN(0, leaving);
WORD_IN(1, voxels);
WORD_IN(2, colors);
WORD_INOUT(3, keys);
WORD_INOUT(4, colored);
WORD_INOUT(5, free_blocks);
WORD_INOUT(6, state);
WORD_OUT(7, moved);

void main() {
  uint n = gl_WorkGroupID.x, own = gl_LocalInvocationIndex, place = FETCH1(leaving, int(kLeavingPlaces + n));
  for (uint i = own; i < kBlockWords; i += 64u)
    STORE(moved, kMovedBlocks + kBlockWords * n + i,
          i < kBlockVoxels ? FETCH1(voxels, int(kBlockVoxels * place + i)) : FETCH1(colors, int(2u * kBlockVoxels * place + i - kBlockVoxels)));
  if (own > 0u) return;
  STORE(moved, kMovedKeys + n, LOAD(keys, place));
  STORE(keys, place, kNoBlock);
  STORE(colored, place, 0u);
  STORE(free_blocks, atomicAdd(LOAD(state, kFree), 1u), place);
}
