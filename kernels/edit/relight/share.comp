// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "edit/edit.glsl"

// Shares of bounced light in S, after light of lamps was added: t' = t kept.
PLANE_IN(0, shares);
SCALAR_IN(1, kept);  // apply.comp
PLANE_OUT(2, edited);
layout(push_constant) uniform Push {
  uvec2 size;
  uint first_row;
} push;

void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y * kRows);
  if (at.x >= push.size.x) return;
  uint last = min(at.y + kRows, push.size.y);
  for (uint y = at.y; y < last; ++y) {
    int n = int(y * push.size.x + at.x);
    STORE(edited, BY_ROWS(n), FETCH1(kept, n) * finite(FETCH(shares, n)));
  }
}
