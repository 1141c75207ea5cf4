// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "object.glsl"

// The first guess at the object: cells whose color is about that under the user's strokes.
PLANE_IN(0, colors);
SCALAR_IN(1, model);
PLANE_IN(2, totals);
WORD_IN(3, seeds);
SCALAR_OUT(4, alpha);
layout(push_constant) uniform Push { uvec2 cells; } push;

void main() {
  uvec2 cell = gl_GlobalInvocationID.xy;
  if (cell.x >= push.cells.x) return;
  uint n = cell.y * push.cells.x + cell.x;
  float top = FETCH(totals, kAddedDensity).y;
  uint seed = FETCH1(seeds, int(n));
  bool own = top > 0.0 && FETCH1(model, kAddedDensity * kBinCount + bin_of(FETCH(colors, int(n)).rgb)) > kStartColor * top;
  STORE(alpha, n, seed == kSeedAdd || (own && seed != kSeedSubtract) ? 1.0 : 0.0);
}
