// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"

// A step by the factor that search.comp says; 1 leaves it to the bit, and 0 nothing of it, also where it is no number. In
// place; the dispatch's z is the plane of the field.
PLANE_IN(0, state);
SCALAR_IN(1, search);
PLANE_INOUT(2, next);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  float factor = FETCH1(search, 1);
  if (at.x >= push.size.x || factor == 1.0) return;
  int n = (int(gl_WorkGroupID.z) * push.size.y + at.y) * push.size.x + at.x;
  vec4 from = FETCH(state, n);
  STORE(next, n, factor == 0.0 ? from : from + factor * (LOAD(next, n) - from));
}
