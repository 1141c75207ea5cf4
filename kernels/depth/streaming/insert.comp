// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/blocks.glsl"

// Fills an empty hash table with the blocks of the pool. One block of the pool an invocation.
WORD_IN(0, keys);
WORD_INOUT(1, table);
layout(push_constant) uniform Push {
  uint blocks;
  uint table_mask;
} push;

void main() {
  uint block = line_index();
  if (block >= push.blocks) return;
  uint key = FETCH1(keys, int(block));
  if (key == kNoBlock) return;
  uint entry = hash_of(key) & push.table_mask;
  for (uint probe = 0u; probe < kMaxProbes; ++probe) {
    if (atomicCompSwap(LOAD(table, 2u * entry), kNoBlock, key) == kNoBlock) {
      STORE(table, 2u * entry + 1u, block);
      return;
    }
    entry = (entry + 1u) & push.table_mask;
  }
}
