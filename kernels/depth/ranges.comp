// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/blocks.glsl"
#include "camera/camera.glsl"
#include "state.glsl"

// The range of depths in which each tile of 8 × 8 pixels sees blocks of the list. One block of the list an invocation.
WORD_IN(0, list);
WORD_IN(1, state);
WORD_IN(2, keys);
PLANE_IN(3, pose);
WORD_INOUT(4, nearest);   // a tile: bits of a float
WORD_INOUT(5, farthest);
layout(push_constant) uniform Push {
  vec4 lens;
  uvec2 tiles;
  float voxel;
  float min_depth;
} push;

void main() {
  uint n = line_index();
  if (n >= FETCH1(state, int(kListed))) return;
  float side = float(kBlockSide) * push.voxel, radius = 0.5 * sqrt(3.0) * side;
  ivec3 block = block_of_key(FETCH1(keys, int(FETCH1(list, int(n)) & 0x7fffffffu)));
  vec3 center = to_camera(FETCH(pose, 0), FETCH(pose, 1), (vec3(block) + 0.5) * side);
  float near = max(center.z - radius, push.min_depth), far = center.z + radius;
  if (far <= push.min_depth) return;
  // All that the ball may cover, for any of its depths.
  vec2 low = min((center.xy - radius) / near, (center.xy - radius) / far), high = max((center.xy + radius) / near, (center.xy + radius) / far);
  ivec2 first = max(ivec2(floor((push.lens.xy * low + push.lens.zw + 0.5) / 8.0)), ivec2(0));
  ivec2 last = min(ivec2(floor((push.lens.xy * high + push.lens.zw + 0.5) / 8.0)), ivec2(push.tiles) - 1);
  for (int y = first.y; y <= last.y; ++y)
    for (int x = first.x; x <= last.x; ++x) {
      uint tile = uint(y) * push.tiles.x + uint(x);
      atomicMin(LOAD(nearest, tile), floatBitsToUint(near));
      atomicMax(LOAD(farthest, tile), floatBitsToUint(far));
    }
}
