// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "object.glsl"

// Counts the colors of cells for one of the densities. Those of the background are away from the object and have none of its colors.
layout(constant_id = 1) const int DENSITY = 0;
PLANE_IN(0, colors);
SCALAR_IN(1, alpha);
WORD_IN(2, region);
WORD_IN(3, seeds);
WORD_IN(4, near);
SCALAR_IN(5, model);
PLANE_IN(6, totals);
WORD_INOUT(7, counts);
layout(push_constant) uniform Push { uvec2 cells; } push;

void main() {
  uvec2 cell = gl_GlobalInvocationID.xy;
  if (cell.x >= push.cells.x) return;
  int n = int(cell.y * push.cells.x + cell.x);
  int bin = bin_of(FETCH(colors, n).rgb);
  uint seed = FETCH1(seeds, n), count = 0u;
  if (DENSITY == kAddedDensity) {
    count = seed == kSeedAdd ? kFullCount : 0u;
  } else if (DENSITY == kSubtractedDensity) {
    count = seed == kSeedSubtract || (seed == kSeedAround && FETCH1(region, n) == 0u) ? kFullCount : 0u;
  } else if (DENSITY == kObjectDensity) {
    count = FETCH1(region, n) == 0u ? 0u : uint(float(kFullCount) * clamp(FETCH1(alpha, n), 0.0, 1.0) + 0.5);
  } else {
    uint block = cell.y / uint(kCoarse) * ((push.cells.x + uint(kCoarse) - 1u) / uint(kCoarse)) + cell.x / uint(kCoarse);
    bool own = FETCH1(model, bin) > kOwnColor * FETCH(totals, kObjectDensity).y ||
               FETCH1(model, kAddedDensity * kBinCount + bin) > kOwnColor * FETCH(totals, kAddedDensity).y;
    count = FETCH1(near, int(block)) == 0u && !own ? 1u : 0u;
  }
  if (count > 0u) atomicAdd(LOAD(counts, bin), count);
}
