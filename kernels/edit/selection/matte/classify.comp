// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "matte.glsl"

// The class of every cell.
WORD_IN(0, region);
WORD_OUT(1, classes);
layout(push_constant) uniform Push { ivec2 cells; } push;

void main() {
  ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
  if (cell.x >= push.cells.x) return;
  uvec2 selected = uvec2(0u), count = uvec2(0u);  // within one cell, and two
  for (int dy = -2; dy <= 2; ++dy)
    for (int dx = -2; dx <= 2; ++dx) {
      ivec2 at = cell + ivec2(dx, dy);
      if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, push.cells))) continue;
      uvec2 here = uvec2(max(abs(dx), abs(dy)) <= 1 ? 1u : 0u, 1u);
      count += here;
      selected += here * FETCH1(region, at.y * push.cells.x + at.x);
    }
  uint own = selected.x == count.x ? kCore : selected.x == 0u ? kOutside : kMixed;
  STORE(classes, uint(cell.y * push.cells.x + cell.x), own + (selected.y == count.y || selected.y == 0u ? 0u : kBorder));
}
