// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "key.glsl"

// Fills in from coarser cells what a cell's weight w leaves open. w becomes at least kFilled, or 0 if there is nothing to fill in with.
PLANE_IN(0, coarse);
PLANE_INOUT(1, fine);
layout(push_constant) uniform Push {
  uvec2 from;
  uvec2 to;
} push;

const float kFilled = 0.01;

void main() {
  uvec2 cell = gl_GlobalInvocationID.xy;
  if (cell.x >= push.to.x) return;
  uint n = cell.y * push.to.x + cell.x;
  vec4 own = LOAD(fine, n);
  Place place = place_of(cell, push.from, 0.5);
  vec4 wide = AROUND(coarse, place);
  float rest = wide.w > 0.0 ? 1.0 - own.w : 0.0, all = own.w + rest;
  STORE(fine, n, all > 0.0 ? vec4((own.w * own.rgb + rest * wide.rgb) / all, max(own.w, kFilled)) : vec4(0.0));
}
