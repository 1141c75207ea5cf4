// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/blocks.glsl"
#include "depth/state.glsl"
#include "camera/voxel.glsl"
#include "moves.glsl"

// Takes blocks into the pool; where a block has been made anew since it left, the means of both become one. A workgroup of 64 a block.
WORD_IN(0, moved);
WORD_IN(1, free_blocks);
WORD_INOUT(2, table);
WORD_INOUT(3, keys);
WORD_INOUT(4, voxels);
WORD_INOUT(5, colors);
WORD_INOUT(6, colored);
WORD_INOUT(7, state);
WORD_OUT(8, taken);  // whether each one has found a place
layout(push_constant) uniform Push { uint table_mask; } push;

shared uint place;
shared bool made;

// The place of a block, taken from the free ones if it has none; kNoBlock: there is none.
void find(uint key) {
  place = kNoBlock;
  made = false;
  uint entry = hash_of(key) & push.table_mask;
  for (uint probe = 0u; probe < kMaxProbes; ++probe) {
    uint other = atomicCompSwap(LOAD(table, 2u * entry), kNoBlock, key);
    if (other == key) {
      // An entry without a block: there was no memory for it.
      place = LOAD(table, 2u * entry + 1u);
      if (place != kNoBlock) return;
    }
    if (other == key || other == kNoBlock) {
      uint left = atomicAdd(LOAD(state, kFree), 0xffffffffu);
      if (int(left) <= 0) {
        atomicAdd(LOAD(state, kFree), 1u);
        return;
      }
      place = FETCH1(free_blocks, int(left - 1u));
      made = true;
      STORE(table, 2u * entry + 1u, place);
      STORE(keys, place, key);
      STORE(colored, place, 0u);
      return;
    }
    entry = (entry + 1u) & push.table_mask;
  }
}

void main() {
  uint n = gl_WorkGroupID.x, own = gl_LocalInvocationIndex, from = kMovedBlocks + kBlockWords * n;
  if (own == 0u) {
    find(FETCH1(moved, int(kMovedKeys + n)));
    STORE(taken, n, place == kNoBlock ? 0u : 1u);
  }
  barrier();
  if (place == kNoBlock) return;
  bool old = FETCH1(moved, int(kMovedOld + n)) != 0u;
  uint count = 0u;
  for (uint i = own; i < kBlockVoxels; i += 64u) {
    uint at = kBlockVoxels * place + i, color_at = color_index(place, i);
    Voxel v = voxel_of(FETCH1(moved, int(from + i)));
    vec4 color = reflectance_of(uvec2(FETCH1(moved, int(from + kBlockVoxels + i)), FETCH1(moved, int(from + 2u * kBlockVoxels + i))));
    if (old) v.stroke = 0u;
    bool had = false;
    if (!made) {
      Voxel here = voxel_of(LOAD(voxels, at));
      vec4 now = reflectance_of(uvec2(LOAD(colors, color_at), LOAD(colors, color_at + kBlockVoxels)));
      v.distance = (v.distance * v.weight + here.distance * here.weight) / max(v.weight + here.weight, 1.0);
      v.weight = min(v.weight + here.weight, 255.0);
      v.stroke = here.stroke != 0u ? here.stroke : v.stroke;
      color = vec4(mix(color.rgb, now.rgb, now.w / max(color.w + now.w, 1e-9)), min(color.w + now.w, 1.0));
      had = now.w > 0.0;
    }
    uvec2 words = words_of(color);
    STORE(voxels, at, word_of(v));
    STORE(colors, color_at, words.x);
    STORE(colors, color_at + kBlockVoxels, words.y);
    count += color.w > 0.0 && !had ? 1u : 0u;
  }
  if (count > 0u) atomicAdd(LOAD(colored, place), count);
}
