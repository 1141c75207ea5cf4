// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/blocks.glsl"
#include "camera/voxel.glsl"
#include "brush.glsl"

// Marks the voxels under strokes, and takes the marks of strokes that are gone away. What fills begins at new marks, and at all of
// blocks that may spread. A workgroup of 64 a block, a column of 8 voxels an invocation.
WORD_IN(0, list);
WORD_IN(1, keys);
PLANE_IN(2, brushes);  // in the order of their list: later ones cover earlier ones
PLANE_IN(3, balls);    // centers and radii, meters
WORD_IN(4, ids);
WORD_IN(5, colors);
WORD_INOUT(6, voxels);
WORD_INOUT(7, marked);
WORD_INOUT(8, sums);
WORD_INOUT(9, front);
WORD_INOUT(10, state);
layout(push_constant) uniform Push {
  uint brushes;
  float voxel;
} push;
#include "front.glsl"

shared uint near[2];  // a bit a brush: whether it may touch the block
shared uint any_mark;

bool covers(vec4 range, vec3 at) {
  for (int i = 0; i < int(range.y); ++i) {
    vec4 ball = FETCH(balls, int(range.x) + i);
    if (distance(ball.xyz, at) < ball.w) return true;
  }
  return false;
}

void main() {
  uint entry = FETCH1(list, int(gl_WorkGroupID.x)), block = entry & ~LIST_SPREADS, own = gl_LocalInvocationIndex;
  float side = float(kBlockSide) * push.voxel, radius = 0.5 * sqrt(3.0) * side;
  ivec3 first = kBlockSide * block_of_key(FETCH1(keys, int(block))) + ivec3(own & 7u, own >> 3, 0);
  if (own < 2u) near[own] = 0u;
  if (own == 2u) any_mark = 0u;
  barrier();
  if (own < push.brushes) {
    vec4 bound = FETCH(brushes, BRUSH_STRIDE * int(own) + BRUSH_BOUND);
    vec3 center = (vec3(block_of_key(FETCH1(keys, int(block)))) + 0.5) * side;
    if (distance(center, bound.xyz) < radius + bound.w) atomicOr(near[own >> 5], 1u << (own & 31u));
  }
  barrier();
  for (uint k = 0u; k < 8u; ++k) {
    uint place = own + 64u * k, index = block * kBlockVoxels + place;
    Voxel v = voxel_of(LOAD(voxels, index));
    uint before = (FETCH1(ids, int(v.stroke)) & ID_KEPT) != 0u ? v.stroke : 0u, stroke = before;
    bool brushed = false;
    if (v.weight > 0.0 && abs(v.distance) < 1.0) {
      vec3 at = (vec3(first + ivec3(0, 0, k)) + 0.5) * push.voxel;
      for (uint word = 0u; word < 2u; ++word)
        for (uint left = near[word]; left != 0u; left &= left - 1u) {
          vec4 range = FETCH(brushes, BRUSH_STRIDE * int(32u * word + uint(findLSB(left))) + BRUSH_BALLS);
          bool over = before == 0u || (FETCH1(ids, int(range.z)) & ID_FRESH) != 0u;
          if (!over || !covers(range, at)) continue;
          stroke = uint(range.z);
          brushed = true;
        }
    }
    uint what = FETCH1(ids, int(stroke));
    bool spreads = stroke != before || entry != block;
    if (stroke != v.stroke) {
      v.stroke = stroke;
      STORE(voxels, index, word_of(v));
    }
    if (stroke != 0u) any_mark = 1u;
    if (stroke == 0u || (what & ID_FILLS) == 0u) continue;
    int from = int(color_index(block, place));
    vec4 color = reflectance_of(uvec2(FETCH1(colors, from), FETCH1(colors, from + int(kBlockVoxels))));
    if (!(color.w > 0.0)) continue;
    if (brushed && (what & ID_FRESH) != 0u) {
      uvec3 steps = uvec3(kSumSteps * exp(color.rgb) + 0.5);
      for (uint c = 0u; c < 3u; ++c) atomicAdd(LOAD(sums, SUM_STRIDE * stroke + c), steps[c]);
      atomicAdd(LOAD(sums, SUM_STRIDE * stroke + SUM_COUNT), 1u);
    }
    if (spreads) add_to_front(0u, index);
  }
  barrier();
  if (own > 0u) return;
  uint was = LOAD(marked, block);
  STORE(marked, block, any_mark == 0u ? MARKED_NONE : was == MARKED_NONE ? MARKED_NEW : was);
}
