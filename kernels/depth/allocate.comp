// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/blocks.glsl"
#include "camera/camera.glsl"
#include "state.glsl"

// Makes the blocks within the truncation of what a depth camera sees. One pixel in push.step² an invocation.
SCALAR_IN(0, depth);   // meters along the optical axis; 0: unknown
PLANE_IN(1, pose);
WORD_IN(2, free_blocks);
WORD_INOUT(3, table);
WORD_INOUT(4, keys);   // of each block of the pool
WORD_INOUT(5, fresh);  // whether a block has no voxels yet
WORD_INOUT(6, state);
layout(push_constant) uniform Push {
  vec4 lens;
  uvec2 size;
  uint step;
  uint table_mask;
  float voxel;       // side of one in meters
  float truncation;  // meters
  float max_depth;   // meters
} push;

void insert(ivec3 block) {
  if (!has_key(block)) {
    atomicAdd(LOAD(state, kOutside), 1u);
    return;
  }
  uint key = key_of(block), entry = hash_of(key) & push.table_mask;
  for (uint probe = 0u; probe < kMaxProbes; ++probe) {
    uint other = LOAD(table, 2u * entry);
    if (other == kNoBlock) other = atomicCompSwap(LOAD(table, 2u * entry), kNoBlock, key);
    if (other == key) return;
    if (other == kNoBlock) {
      uint left = atomicAdd(LOAD(state, kFree), 0xffffffffu);
      if (int(left) <= 0) {  // the entry stays without a block
        atomicAdd(LOAD(state, kFree), 1u);
        atomicAdd(LOAD(state, kRefused), 1u);
        return;
      }
      uint block_place = FETCH1(free_blocks, int(left - 1u));
      STORE(keys, block_place, key);
      STORE(fresh, block_place, 1u);
      STORE(table, 2u * entry + 1u, block_place);
      atomicAdd(LOAD(state, kMade), 1u);
      return;
    }
    entry = (entry + 1u) & push.table_mask;
  }
  atomicAdd(LOAD(state, kRefused), 1u);
}

void main() {
  uvec2 across = (push.size + push.step - 1u) / push.step;
  uint line = line_index();
  uvec2 pixel = push.step * uvec2(line % across.x, line / across.x);
  if (pixel.y >= push.size.y) return;
  float middle = FETCH1(depth, int(pixel.y * push.size.x + pixel.x));
  if (!(middle > 0.0 && middle <= push.max_depth)) return;
  vec4 rotation = FETCH(pose, 0), place = FETCH(pose, 1);
  vec3 ray = ray_of(push.lens, vec2(pixel));
  // Along the ray, at most half a block apart: a block that is only cut at a corner may be missed.
  float reach = push.truncation / length(ray), side = float(kBlockSide) * push.voxel;
  int steps = int(ceil(4.0 * push.truncation / side));
  for (int i = 0; i <= steps; ++i) {
    float z = middle + reach * (2.0 * float(i) / float(steps) - 1.0);
    if (z > 0.0) insert(ivec3(floor(to_world(rotation, place, z * ray) / side)));
  }
}
