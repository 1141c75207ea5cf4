#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "tiles.glsl"

// Keeps what the listed tiles' edges are evaluated on. One cell of guide level 1 an invocation.
PLANE_IN(0, level1);
WORD_IN(1, control);
WORD_IN(2, list);
PLANE_OUT(3, kept);
layout(push_constant) uniform Push { uvec2 size; } push;  // of level 1

void main() {
  uint i = gl_GlobalInvocationID.x, slot = i / uint(TILE_CELLS * TILE_CELLS), cell = i % uint(TILE_CELLS * TILE_CELLS);
  if (slot >= FETCH1(control, CONTROL_COUNT)) return;
  uint tile = FETCH1(list, int(slot)), columns = (push.size.x + uint(TILE_CELLS) - 1u) / uint(TILE_CELLS);
  uvec2 at = uvec2(tile % columns, tile / columns) * uint(TILE_CELLS) + uvec2(cell % uint(TILE_CELLS), cell / uint(TILE_CELLS));
  if (at.x >= push.size.x || at.y >= push.size.y) return;
  uint to = at.y * push.size.x + at.x;
  STORE(kept, to, FETCH(level1, int(to)));
}
