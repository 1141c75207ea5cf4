// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#include "search.glsl"

// Scales a step by the factor of search.comp. A factor of 1 changes no bit; a factor of 0 gives 0, also for NaN. In
// place; the dispatch's z is the plane of the field.
PLANE_IN(0, state);
SCALAR_IN(1, search);
PLANE_INOUT(2, next);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  float factor = FETCH1(search, SEARCH_FACTOR);
  if (at.x >= push.size.x || factor == 1.0) return;
  int n = (int(gl_WorkGroupID.z) * push.size.y + at.y) * push.size.x + at.x;
  vec4 from = FETCH(state, n);
  STORE(next, n, factor == 0.0 ? from : from + factor * (LOAD(next, n) - from));
}
