// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "image/pack4.glsl"
#include "intrinsic/guide/guide.glsl"

// Flags the tiles whose edges have to be evaluated again: those with a cell of guide level 1, in the tile or up to two cells around
// it, that differs by more than the tolerance from the saved one; all tiles if the frame's statistics differ so (the mean by
// kMeanDrift times the tolerance), or if no edges are evaluated yet (all = 1). One tile a workgroup.
PLANE_IN(0, level1);
PLANE_IN(1, kept);
PLANE_IN(2, statistics);
PLANE_IN(3, kept_statistics);
WORD_IN(4, outdated);  // 0, or all tiles are flagged: what DepthCue sees has changed
WORD_OUT(5, flags);
layout(push_constant) uniform Push {
  uvec2 size;  // of level 1
  float tolerance;
  uint all;
} push;

const int kTileCells = 8;  // along a tile
const float kMeanDrift = 4.0;

void main() {
  uvec2 tiles = (push.size + uint(kTileCells) - 1u) / uint(kTileCells), tile = grid_place(line_index() / gl_WorkGroupSize.x, tiles.x);
  if (tile.y >= tiles.y) return;
  // Comparisons are false for NaN.
  vec4 tolerance = vec4(push.tolerance);
  vec2 drift = abs(FETCH(statistics, STATISTICS_MEAN).xy - FETCH(kept_statistics, STATISTICS_MEAN).xy);
  bool same = drift.x <= kMeanDrift * push.tolerance && drift.y <= push.tolerance &&
              all(lessThanEqual(abs(FETCH(statistics, STATISTICS_SIGMAS) - FETCH(kept_statistics, STATISTICS_SIGMAS)), tolerance));
  ivec2 first = max(ivec2(tile) * kTileCells - 2, ivec2(0));
  ivec2 last = min(ivec2(tile) * kTileCells + kTileCells + 1, ivec2(push.size) - 1);
  float changed = 0.0;
  for (int y = first.y + int(gl_LocalInvocationID.x / 4u); y <= last.y; y += int(gl_WorkGroupSize.x / 4u))
    for (int x = first.x + int(gl_LocalInvocationID.x % 4u); x <= last.x; x += 4) {
      int at = y * int(push.size.x) + x;
      changed += all(lessThanEqual(abs(FETCH(level1, at) - FETCH(kept, at)), tolerance)) ? 0.0 : 1.0;
    }
  changed = workgroup_sum(vec4(changed)).x;
  if (gl_LocalInvocationID.x == 0u)
    STORE(flags, tile.y * tiles.x + tile.x, push.all == 1u || FETCH1(outdated, 0) != 0u || !same || changed > 0.0 ? 1u : 0u);
}
