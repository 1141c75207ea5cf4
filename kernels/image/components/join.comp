// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#define ROOTS_SLOT 1
#include "components.glsl"

// Joins the components of neighbors with the same label, which is w of a pixel; below 0: in no component.
PLANE_IN(0, labels);
layout(push_constant) uniform Push { ivec2 size; } push;

void join(uint a, uint b) {
  for (;;) {
    a = root_of(a);
    b = root_of(b);
    if (a == b) return;
    uint low = min(a, b), high = max(a, b);
    uint before = atomicMin(roots_data[high], low);
    if (before == high) return;
    // Another invocation won: what it joined `high` to has to be joined, too.
    a = before;
    b = low;
  }
}

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  float own = FETCH(labels, n).w;
  if (own < 0.0) return;
  if (at.x + 1 < push.size.x && FETCH(labels, n + 1).w == own) join(uint(n), uint(n + 1));
  if (at.y + 1 < push.size.y && FETCH(labels, n + push.size.x).w == own) join(uint(n), uint(n + push.size.x));
}
