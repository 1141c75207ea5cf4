#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "tiles.glsl"

// How many workgroups the listed tiles need. Keeps the frame's statistics where all tiles are listed. One invocation.
PLANE_IN(0, statistics);
WORD_INOUT(1, control);
PLANE_OUT(2, kept_statistics);
layout(push_constant) uniform Push {
  uint tiles;
  uint workgroup;
} push;

void main() {
  if (gl_GlobalInvocationID.x > 0u) return;
  uint count = LOAD(control, CONTROL_COUNT);
  STORE(control, CONTROL_EDGES, (count * uint(TILE_BLOCKS) + push.workgroup - 1u) / push.workgroup);
  STORE(control, CONTROL_EDGES + 1, 1u);
  STORE(control, CONTROL_EDGES + 2, 1u);
  STORE(control, CONTROL_KEEP, (count * uint(TILE_CELLS * TILE_CELLS) + push.workgroup - 1u) / push.workgroup);
  STORE(control, CONTROL_KEEP + 1, 1u);
  STORE(control, CONTROL_KEEP + 2, 1u);
  if (count == push.tiles) {
    STORE(kept_statistics, 0, FETCH(statistics, 0));
    STORE(kept_statistics, 1, FETCH(statistics, 1));
  }
}
