// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "guide.glsl"
#include "image/pack4.glsl"

// The guide's level 4 from its level 2. One cell of level 4 an invocation.
PLANE_IN(0, cells);
PLANE_OUT(1, guide_coarse);
layout(push_constant) uniform Push { uvec2 size; } push;  // of level 2

void main() {
  uvec2 half_size = (push.size + 1u) / 2u, wide_size = (half_size + 1u) / 2u, cell = grid_position(wide_size.x);
  if (cell.y >= wide_size.y) return;
  vec4 sum = vec4(0.0);
  for (uint k = 0u; k < 16u; ++k) {
    uvec2 parent = min(2u * cell + uvec2((k >> 1u) & 1u, k >> 3u), half_size - 1u);
    uvec2 at = min(2u * parent + uvec2(k & 1u, (k >> 2u) & 1u), push.size - 1u);
    sum += FETCH(cells, int(CELL_STRIDE * (at.y * push.size.x + at.x)));
  }
  STORE(guide_coarse, cell.y * wide_size.x + cell.x, sum / 16.0);
}
