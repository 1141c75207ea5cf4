// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"
#include "intrinsic/guide/guide.glsl"
#include "intrinsic/temporal/temporal.glsl"

// Right-hand side of the pixels, from the flux of the edges and, with kAnchored, from the frame before; and the initial solution:
// max_c i shifted to the initial value of the pixels' cell, or, as far as the gate is open, the reflectance of the frame before.
// One pack an invocation.
layout(constant_id = 1) const bool kAnchored = false;
PLANE_IN(0, flux);
PLANE_IN(1, start);    // of cells (cell_terms.comp)
PLANE_IN(2, level0);
PLANE_IN(3, source_term);         // of cells, with their anchors
PLANE_IN(4, memory);        // the last frame's
PLANE_IN(5, last_shading);  // its solution
PLANE_OUT(6, system);       // SYSTEM_FINE_STRIDE
PLANE_OUT(7, shading);      // the same buffer as the last frame's
PLANE_OUT(8, now);          // m
layout(push_constant) uniform Push { uvec2 size; } push;

void main() {
  uint packs = PACK4(push.size.x);
  uvec2 position = grid_position(packs);
  if (position.y >= push.size.y) return;
  int at = int(position.y * packs + position.x);
  vec4 right = FETCH(flux, FLUX_STRIDE * at + FLUX_RIGHT);
  float left = position.x > 0u ? FETCH(flux, FLUX_STRIDE * (at - 1) + FLUX_RIGHT).w : 0.0;
  vec4 sum = right - SHIFT_RIGHT(right, vec4(left)) + FETCH(flux, FLUX_STRIDE * at + FLUX_DOWN);
  if (position.y > 0u) sum -= FETCH(flux, FLUX_STRIDE * (at - int(packs)) + FLUX_DOWN);
  int cells = int((position.y / 4u) * PACK4(packs) + position.x / 4u);
  vec4 m = vec4(0.0), s = vec4(FETCH(start, START_STRIDE * cells + START_VALUE)[position.x & 3u]);
  for (uint k = 0u; k < 4u; ++k) {
    uint x = min(4u * position.x + k, push.size.x - 1u);
    vec4 guide = FETCH(level0, int(position.y * push.size.x + x));
    m = vec4(m.yzw, guide.x);
    s = vec4(s.yzw, s.x + guide.x + guide.w);
  }
  bvec4 inside = INSIDE(position.x, push.size.x);
  if (kAnchored) {
    float gate = FETCH(start, START_STRIDE * cells + START_GATE)[position.x & 3u];
    float anchor = FETCH(source_term, SOURCE_STRIDE * cells + SOURCE_ANCHOR)[position.x & 3u];
    vec4 before = m - FETCH(memory, MEMORY_STRIDE * at + MEMORY_MEAN) + FETCH(last_shading, at);
    sum += MASKED(anchor * before, inside);
    s += gate * (before - s);
  }
  STORE(system, SYSTEM_FINE_STRIDE * uint(at) + SYSTEM_RHS, sum);
  STORE(shading, uint(at), MASKED(s, inside));
  STORE(now, uint(MEMORY_STRIDE * at) + MEMORY_MEAN, m);
}
