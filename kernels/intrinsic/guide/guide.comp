// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "guide.glsl"
#include "image/pack4.glsl"

// The guide's levels 0 and 1 from the frame: one level-1 cell, 2 x 2 pixels, an invocation.
PLANE_IN(0, frame);
PLANE_OUT(1, fine);
PLANE_OUT(2, coarse);
#define TILE_CONSTANT 1
#define TILE_BINDING 3
#include "image/tiles/tile_position.glsl"
layout(push_constant) uniform Push { uvec2 size; } push;

void main() {
  uvec2 cells = (push.size + 1u) / 2u, cell = tile_position(cells.x);
  if (cell.y >= cells.y) return;
  vec4 sum = vec4(0.0);
  for (uint k = 0u; k < 4u; ++k) {
    uvec2 at = min(2u * cell + uvec2(k & 1u, k >> 1u), push.size - 1u);
    uint pixel = at.y * push.size.x + at.x;
    vec4 guide = guide_of(sanitize(FETCH(frame, int(pixel)).rgb));
    STORE(fine, pixel, guide);
    sum += guide;
  }
  STORE(coarse, cell.y * cells.x + cell.x, 0.25 * sum);
}
