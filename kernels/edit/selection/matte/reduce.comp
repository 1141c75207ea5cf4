// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "matte.glsl"

// Cells that a selection of pixels (x of `selection`) covers more than half.
PLANE_IN(0, selection);
WORD_OUT(1, region);
layout(push_constant) uniform Push {
  uvec2 size;  // of the frame
  uvec2 cells;
  uint side;
} push;

void main() {
  uvec2 cell = gl_GlobalInvocationID.xy;
  if (cell.x >= push.cells.x) return;
  uvec2 first = cell * push.side, last = min(first + push.side, push.size);
  float sum = 0.0;
  for (uint y = first.y; y < last.y; ++y)
    for (uint x = first.x; x < last.x; ++x) sum += min(finite(FETCH(selection, int(y * push.size.x + x))).x, 1.0);
  float count = float((last.x - first.x) * (last.y - first.y));
  STORE(region, cell.y * push.cells.x + cell.x, 2.0 * sum > count ? 1u : 0u);
}
