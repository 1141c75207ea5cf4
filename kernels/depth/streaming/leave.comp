// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/blocks.glsl"
#include "camera/camera.glsl"
#include "moves.glsl"

// Counts the blocks that may leave the pool, as the camera does not see them, by their distance from it; or picks the farthest of them,
// in any order. One block of the pool an invocation.
WORD_IN(0, keys);
PLANE_IN(1, pose);
WORD_INOUT(2, leaving);
layout(push_constant) uniform Push {
  vec4 lens;
  uvec2 size;
  uint blocks;
  float voxel;
  float max_depth;  // meters that the camera sees
  float step;       // of the counts, meters
  float margin;     // meters out of sight
} push;

layout(constant_id = 1) const bool kPicks = true;

void main() {
  uint block = line_index();
  if (block >= push.blocks) return;
  uint key = FETCH1(keys, int(block));
  if (key == kNoBlock) return;
  float side = float(kBlockSide) * push.voxel, reach = 0.5 * sqrt(3.0) * side + push.margin;
  vec3 center = to_camera(FETCH(pose, 0), FETCH(pose, 1), (vec3(block_of_key(key)) + 0.5) * side);
  bool seen = in_sight(push.lens, push.size, push.max_depth, center, reach);
  float distance = length(center);
  if (seen || !(distance >= 0.0)) return;
  uint far = uint(min(distance / push.step, float(kDistances - 1u)));
  if (!kPicks) {
    atomicAdd(LOAD(leaving, kLeavingDistances + far), 1u);
    return;
  }
  uint farther = 0u;
  for (uint i = far + 1u; i < kDistances; ++i) farther += LOAD(leaving, kLeavingDistances + i);
  if (farther >= kMoves) return;
  uint n = atomicAdd(LOAD(leaving, kLeaving), 1u);
  if (n < kMoves)
    STORE(leaving, kLeavingPlaces + n, block);
  else
    atomicAdd(LOAD(leaving, kLeaving), 0xffffffffu);
}
