#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "guide.glsl"
#include "quad.glsl"

// The guide's level 4, m + u only, from its level 2. One cell an invocation.
PLANE_IN(0, cells);
SCALAR_OUT(1, values);
layout(push_constant) uniform Push { uvec2 size; } push;  // of level 2

void main() {
  uvec2 half_size = (push.size + 1u) / 2u, value_size = (half_size + 1u) / 2u, cell = grid_position(value_size.x);
  if (cell.y >= value_size.y) return;
  float sum = 0.0;
  for (uint k = 0u; k < 16u; ++k) {
    uvec2 parent = min(2u * cell + uvec2((k >> 1u) & 1u, k >> 3u), half_size - 1u);
    uvec2 at = min(2u * parent + uvec2(k & 1u, (k >> 2u) & 1u), push.size - 1u);
    vec4 here = FETCH(cells, int(CELL_STRIDE * (at.y * push.size.x + at.x)));
    sum += here.x + here.w;
  }
  STORE(values, cell.y * value_size.x + cell.x, sum / 16.0);
}
