#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "guide.glsl"
#include "quad.glsl"

// The guide's level 2 from its level 0: means over 4 x 4 pixels, and how active they are. One cell an invocation.
PLANE_IN(0, fine);
PLANE_OUT(1, cells);
layout(push_constant) uniform Push { uvec2 size; } push;  // of level 0

void main() {
  uvec2 half_size = (push.size + 1u) / 2u, cell_size = (half_size + 1u) / 2u, cell = grid_position(cell_size.x);
  if (cell.y >= cell_size.y) return;
  vec4 sum = vec4(0.0);
  vec2 activity = vec2(0.0);
  for (uint k = 0u; k < 16u; ++k) {
    uvec2 parent = min(2u * cell + uvec2((k >> 1u) & 1u, k >> 3u), half_size - 1u);
    uvec2 at = min(2u * parent + uvec2(k & 1u, (k >> 2u) & 1u), push.size - 1u);
    uint row = at.y * push.size.x, below = min(at.y + 1u, push.size.y - 1u) * push.size.x;
    vec4 here = FETCH(fine, int(row + at.x));
    vec4 right = here - FETCH(fine, int(row + min(at.x + 1u, push.size.x - 1u)));
    vec4 down = here - FETCH(fine, int(below + at.x));
    sum += here;
    activity += vec2(abs(right.x) + abs(down.x), length(right.yz) + length(down.yz));
  }
  uint to = CELL_STRIDE * (cell.y * cell_size.x + cell.x);
  STORE(cells, to, sum / 16.0);
  STORE(cells, to + 1u, vec4(activity / 16.0, 0.0, 0.0));
}
