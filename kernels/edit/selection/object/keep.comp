// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "object.glsl"
#define ROOTS_SLOT 1
#include "image/components/components.glsl"

// The object: the components that it had a tenth of in the frame before, and those with strokes that add. One that is lost is found
// again in components of its colors that are a quarter of its size.
PLANE_IN(0, labels);
WORD_IN(2, claims);
WORD_IN(3, status);
WORD_IN(4, last_area);
SCALAR_INOUT(5, alpha);
WORD_OUT(6, region);
layout(constant_id = 1) const bool SEEDED = false;  // only components with strokes
layout(push_constant) uniform Push { uvec2 cells; } push;

void main() {
  uvec2 cell = gl_GlobalInvocationID.xy;
  if (cell.x >= push.cells.x) return;
  uint n = cell.y * push.cells.x + cell.x;
  bool inside = FETCH(labels, int(n)).w >= 0.0, kept = false;
  if (inside) {
    int root = 3 * int(root_of(n));
    uint size = FETCH1(claims, root), claimed = FETCH1(claims, root + 1);
    kept = FETCH1(claims, root + 2) != 0u;
    if (!SEEDED) {
      if (FETCH1(status, kArea) == 0u)
        kept = kept || (2u * claimed >= size && FETCH1(last_area, 0) > 0u && 4u * size >= FETCH1(last_area, 0));
      else
        kept = kept || 10u * claimed >= size;
    }
  }
  STORE(region, n, kept ? 1u : 0u);
  if (inside && !kept) STORE(alpha, n, 0.0);
}
