// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "regions.glsl"
#define ROOTS_SLOT 3
#include "image/components/components.glsl"

// Tracking: a pixel that was in a region and still has its cluster claims its component for it.
PLANE_IN(0, features);
PLANE_IN(1, regions);
WORD_IN(2, clusters);  // + 1, of each region
WORD_INOUT(4, claims);
WORD_IN(5, orders);
WORD_OUT(6, counts);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  int number = int(FETCH(regions, n).y);
  uint cluster = uint(FETCH(features, n).w + 1.0);
  uint claim = FETCH1(orders, kMaxRegions + number);
  if (number > 0 && cluster > 0u && FETCH1(clusters, number) == cluster && claim != 0u) {
    atomicMax(claims_data[root_of(uint(n))], claim);
    STORE(counts, claimed_at(uint(number)), 1u);
  }
}
