// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "object.glsl"

// Adds new strokes to those that are remembered, and forgets those on what has moved away.
PLANE_IN(0, colors);
WORD_IN(1, drawn);
WORD_IN(2, region);
PLANE_INOUT(3, memory);
WORD_OUT(4, seeds);
layout(push_constant) uniform Push { uvec2 cells; } push;

void main() {
  uvec2 cell = gl_GlobalInvocationID.xy;
  if (cell.x >= push.cells.x) return;
  uint n = cell.y * push.cells.x + cell.x;
  vec3 color = FETCH(colors, int(n)).rgb;
  vec4 now = LOAD(memory, n);
  if (!(distance(color, now.rgb) <= kMemoryReach)) now = vec4(0.0);
  uint stroke = FETCH1(drawn, int(n));
  if (stroke == kSeedAround && FETCH1(region, int(n)) != 0u) stroke = 0u;
  if (stroke != 0u) now = vec4(color, stroke == kSeedAdd ? kUnderStroke : -kUnderStroke);
  STORE(memory, n, now);
  STORE(seeds, n, now.w > 1.0 ? kSeedAdd : now.w < -1.0 ? kSeedSubtract : 0u);
}
