// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "key.glsl"

// How much the mean of each cell counts: fully if all cells around it are of its kind, so that no mixed pixel is in it; little where
// nothing but slivers is seen.
PLANE_IN(0, means);
PLANE_OUT(1, trusted);
layout(push_constant) uniform Push { ivec2 cells; } push;

const float kNone = 0.4, kAll = 0.8;   // share of a cell's pixels
const float kSliver = 0.01;

void main() {
  ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
  if (cell.x >= push.cells.x) return;
  ivec2 first = max(cell - 1, ivec2(0)), last = min(cell + 1, push.cells - 1);
  float lowest = 1.0;
  for (int y = first.y; y <= last.y; ++y)
    for (int x = first.x; x <= last.x; ++x) lowest = min(lowest, FETCH(means, y * push.cells.x + x).w);
  uint n = uint(cell.y * push.cells.x + cell.x);
  vec4 own = FETCH(means, int(n));
  STORE(trusted, n, vec4(own.rgb, max(rising(kNone, kAll, lowest), kSliver * own.w)));
}
