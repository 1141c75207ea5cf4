// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "regions.glsl"
#define ROOTS_SLOT 2
#include "image/components/components.glsl"

// The regions of this frame, (slot of the base color that overrules or −1, number or 0), and their pixels counted.
WORD_IN(0, claims);
WORD_IN(1, orders);
PLANE_OUT(3, regions);
WORD_INOUT(4, counts);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  uint number = claiming_region(FETCH1(claims, int(root_of(uint(n)))));
  float color = number > 0u ? float(FETCH1(orders, int(number))) - 1.0 : -1.0;
  STORE(regions, n, vec4(color, float(number), 0.0, 0.0));
  if (number > 0u) atomicAdd(counts_data[pixels_at(number)], 1u);
}
