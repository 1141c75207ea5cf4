// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"

// Flags the tiles that a frame works on: those whose input changed, and those whose estimated error exceeds `tolerance`. The
// estimate is the number of frames since the tile was solved, times the larger of its last change per frame and the last coarse
// correction there. One tile an invocation.
WORD_IN(0, changed);
PLANE_IN(1, correction);  // of packs of cells: by the last cycle of the coarse solve
PLANE_INOUT(2, activity);
WORD_OUT(3, flags);
layout(push_constant) uniform Push {
  uvec2 tiles;
  uvec2 cell_packs;  // a row, rows
  float tolerance;   // log units; negative: all tiles
  float hold;        // share of reflectance that is kept from frame to frame without changes
} push;
#include "activity.glsl"

void main() {
  uvec2 tile = grid_position(push.tiles.x);
  if (tile.y >= push.tiles.y) return;
  uint at = tile.y * push.tiles.x + tile.x;
  vec4 max_correction = vec4(0.0);
  for (uint y = 4u * tile.y; y < min(4u * tile.y + 4u, push.cell_packs.y); ++y)
    max_correction = max(max_correction, abs(FETCH(correction, int(y * push.cell_packs.x + tile.x))));
  vec4 state = LOAD(activity, at);
  bool near = near_change(ivec2(tile), ivec2(push.tiles));
  float frames = near ? 1.0 : state.y + 1.0;
  float coarse = (1.0 - pow(push.hold, state.z)) / state.z * max(max(max_correction.x, max_correction.y), max(max_correction.z, max_correction.w));
  bool skipped = !near && frames * max(state.x, coarse) <= push.tolerance;  // not for NaN
  STORE(flags, at, skipped ? 0u : 1u);
  STORE(activity, at, vec4(state.x, frames, state.z, 0.0));
}
