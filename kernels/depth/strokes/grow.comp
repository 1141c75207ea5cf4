// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/voxel.glsl"
#include "image/strokes/strokes.glsl"
#include "brush.glsl"

// Filling (thesis, 4.5.2): voxels of the front mark those of their 26 neighbors that have a reflectance near the mean under the
// stroke's brush; these are the next front. Near is as in the thesis, and within a factor: in dark paint the thesis' distance is no
// limit. One voxel of the front an invocation.
WORD_IN(0, table);
WORD_IN(1, keys);
WORD_IN(2, colors);
WORD_IN(3, sums);
WORD_INOUT(4, voxels);
WORD_INOUT(5, marked);
WORD_INOUT(6, front);
WORD_INOUT(7, state);
layout(push_constant) uniform Push {
  uint table_mask;
  uint pass;
} push;
#include "camera/find_block.glsl"
#include "front.glsl"

const float kFillFactor = 1.5;

bool near(vec3 color, vec3 mean) {
  vec3 ratio = color / max(mean, 1e-4);
  return distance(color, mean) < kFillDistance && all(lessThan(ratio, vec3(kFillFactor))) && all(greaterThan(ratio, vec3(1.0 / kFillFactor)));
}

void main() {
  uint n = gl_WorkGroupID.x * FRONT_GROUP + gl_LocalInvocationIndex;
  if (n >= min(LOAD(state, push.pass * STATE_STRIDE + STATE_FRONT), FRONT_MAX)) return;
  uint index = LOAD(front, (push.pass & 1u) * FRONT_MAX + n), block = index / kBlockVoxels, place = index % kBlockVoxels;
  uint stroke = LOAD(voxels, index) >> 24;
  int sum = int(SUM_STRIDE * stroke);
  float count = float(FETCH1(sums, sum + SUM_COUNT));
  if (stroke == 0u || count == 0.0) return;
  vec3 mean = vec3(FETCH1(sums, sum), FETCH1(sums, sum + 1), FETCH1(sums, sum + 2)) / (kSumSteps * count);
  ivec3 block_at = block_of_key(FETCH1(keys, int(block)));
  ivec3 voxel = kBlockSide * block_at + ivec3(place & 7u, place >> 3 & 7u, place >> 6);
  for (int i = 0; i < 27; ++i) {
    ivec3 next = voxel + ivec3(i % 3, i / 3 % 3, i / 9) - 1, next_block = block_of(next);
    uint in_block = next_block == block_at ? block : find_block(next_block);
    if (in_block == kNoBlock) continue;
    uint to = in_block * kBlockVoxels + place_in_block(next), word = LOAD(voxels, to);
    Voxel v = voxel_of(word);
    if (v.stroke != 0u || !(v.weight > 0.0)) continue;
    int from = int(color_index(in_block, place_in_block(next)));
    vec4 color = reflectance_of(uvec2(FETCH1(colors, from), FETCH1(colors, from + int(kBlockVoxels))));
    if (!(color.w > 0.0) || !near(exp(color.rgb), mean)) continue;
    if (atomicCompSwap(LOAD(voxels, to), word, word | stroke << 24) != word) continue;
    STORE(marked, in_block, MARKED_NEW);
    add_to_front(push.pass + 1u, to);
  }
}
