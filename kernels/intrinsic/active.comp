#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "quad.glsl"

// Flags the tiles that a frame has to work on: those where the input changed, those whose solution still moved in the last
// frame, and those left out that the coarse solve would move by now. One tile an invocation.
WORD_IN(0, changed);
PLANE_IN(1, correction);  // of quads of cells: what the last cycle of the coarse solve added or, where left out, would add
SCALAR_INOUT(2, activity);
WORD_OUT(3, flags);
layout(push_constant) uniform Push {
  uvec2 tiles;
  uvec2 cell_quads;  // a row, rows
  float tolerance;   // log units
  float moves;       // share of a correction that shows where the input stays the same
} push;
#include "activity.glsl"

void main() {
  uvec2 tile = grid_position(push.tiles.x);
  if (tile.y >= push.tiles.y) return;
  uint at = tile.y * push.tiles.x + tile.x;
  vec4 most = vec4(0.0);
  for (uint y = 4u * tile.y; y < min(4u * tile.y + 4u, push.cell_quads.y); ++y)
    most = max(most, abs(FETCH(correction, int(y * push.cell_quads.x + tile.x))));
  float moved = LOAD(activity, at);
  if (moved == kLeftOut) moved = push.moves * max(max(most.x, most.y), max(most.z, most.w));
  bool still = moved <= push.tolerance && !near_change(ivec2(tile), ivec2(push.tiles));  // not for NaN
  STORE(flags, at, still ? 0u : 1u);
  if (still) STORE(activity, at, kLeftOut);
}
