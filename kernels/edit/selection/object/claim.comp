// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "object.glsl"
#define ROOTS_SLOT 2
#include "image/components/components.glsl"

// Counts the cells of every component, and those that the object had in the frame before; marks components with strokes that add.
// If the object is lost, cells whose color is surely its own count instead.
PLANE_IN(0, labels);
WORD_IN(1, region);
WORD_IN(3, seeds);
PLANE_IN(4, terms);
WORD_IN(5, status);
WORD_INOUT(6, claims);  // size, claimed, seeded
layout(push_constant) uniform Push { uvec2 cells; } push;

void main() {
  uvec2 cell = gl_GlobalInvocationID.xy;
  if (cell.x >= push.cells.x) return;
  int n = int(cell.y * push.cells.x + cell.x);
  if (FETCH(labels, n).w < 0.0) return;
  uint root = 3u * root_of(uint(n));
  vec2 prior = FETCH(terms, n).xy;
  bool lost = FETCH1(status, kArea) == 0u;
  bool claimed = lost ? prior.x > 0.9 * prior.y && prior.y > 0.9 * kPriorWeight : FETCH1(region, n) != 0u;
  atomicAdd(LOAD(claims, root), 1u);
  if (claimed) atomicAdd(LOAD(claims, root + 1u), 1u);
  if (FETCH1(seeds, n) == kSeedAdd) atomicOr(LOAD(claims, root + 2u), 1u);
}
