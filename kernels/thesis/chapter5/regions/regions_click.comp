// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "regions.glsl"
#define ROOTS_SLOT 3
#include "image/components/components.glsl"

// One invocation for each click: the component under it becomes a region with its cluster, also if it is in one already.
PLANE_IN(0, features);
WORD_IN(1, orders);
WORD_OUT(2, clusters);
WORD_INOUT(4, claims);

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= push.clicks) return;
  int at = 2 * kMaxRegions + 4 * i;
  uint n = FETCH1(orders, at + 1) * uint(push.size.x) + FETCH1(orders, at);
  uint claim = FETCH1(orders, at + 2);
  uint cluster = uint(FETCH(features, int(n)).w + 1.0);
  uint expected = FETCH1(orders, at + 3);
  cluster = expected == 0u || expected == cluster ? cluster : 0u;
  STORE(clusters, claiming_region(claim), cluster);
  if (cluster > 0u) atomicMax(claims_data[root_of(n)], claim);
}
