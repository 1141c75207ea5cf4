// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "object.glsl"

// What strokes of both kinds decide of a cell: whether those that add (1) or that subtract (-1) are nearer.
PLANE_IN(0, colors);
PLANE_IN(1, paths);
WORD_IN(2, seeds);
PLANE_INOUT(3, memory);
layout(push_constant) uniform Push { uvec2 cells; } push;

void main() {
  uvec2 cell = gl_GlobalInvocationID.xy;
  if (cell.x >= push.cells.x) return;
  uint n = cell.y * push.cells.x + cell.x;
  if (FETCH1(seeds, int(n)) != 0u) return;
  vec2 path = FETCH(paths, int(n)).xy;
  float nearer = max(path.x, path.y) < 0.1 * kNoPath ? 2.0 / (1.0 + exp(clamp((path.x - path.y) / kPathScale, -40.0, 40.0))) - 1.0 : 0.0;
  STORE(memory, n, vec4(FETCH(colors, int(n)).rgb, nearer));
}
