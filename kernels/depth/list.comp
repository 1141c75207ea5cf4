// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/blocks.glsl"
#include "camera/camera.glsl"
#include "state.glsl"

// Lists the blocks that a camera may see, in any order. One block of the pool an invocation.
WORD_IN(0, keys);
PLANE_IN(1, pose);
WORD_INOUT(2, fresh);
WORD_INOUT(3, state);
WORD_OUT(4, list);  // places of blocks; the highest bit is set if it has no voxels yet
layout(push_constant) uniform Push {
  vec4 lens;
  uvec2 size;
  uint blocks;
  float voxel;
  float max_depth;
} push;

void main() {
  uint block = line_index();
  if (block >= push.blocks) return;
  uint key = FETCH1(keys, int(block));
  if (key == kNoBlock) return;
  float side = float(kBlockSide) * push.voxel, radius = 0.5 * sqrt(3.0) * side;
  vec3 center = to_camera(FETCH(pose, 0), FETCH(pose, 1), (vec3(block_of_key(key)) + 0.5) * side);
  bool seen = in_sight(push.lens, push.size, push.max_depth, center, radius);
  bool first = LOAD(fresh, block) != 0u;
  if (!seen && !first) return;
  STORE(fresh, block, 0u);
  STORE(list, atomicAdd(LOAD(state, kListed), 1u), first ? block | 0x80000000u : block);
}
