// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"

// Chebyshev's step after a cycle that led from s_k to V(s_k): s_(k+1) = s_(k-1) + w (c (V(s_k) - s_k) + s_k - s_(k-1)), with
// w and c from the range of error factors of a cycle (multigrid.cpp). In place. With kMeasure also sums up how much the cycle
// changed, squared. The result is the next cycle's start, unless this is the last one. One pack an invocation.
layout(constant_id = 1) const bool kMeasure = false;
PLANE_IN(0, now);
PLANE_IN(1, start);   // s_k
PLANE_IN(2, before);  // s_(k-1)
PLANE_OUT(3, next);   // the same buffer as `now`
PLANE_OUT(4, next_start);  // the same buffer as `before`, or as `start` if that is s_(k-1), too
PLANE_OUT(5, sums);
layout(push_constant) uniform Push {
  uvec2 packs;  // a row, rows
  float w;
  float c;
  uint last;  // 1 if no cycle follows
} push;

void main() {
  uvec2 position = grid_position(push.packs.x);
  vec4 change = vec4(0.0);
  if (position.y < push.packs.y) {
    uint i = position.y * push.packs.x + position.x;
    vec4 s = FETCH(start, int(i)), old = FETCH(before, int(i));
    change = FETCH(now, int(i)) - s;
    vec4 result = old + push.w * (push.c * change + s - old);
    STORE(next, i, result);
    if (push.last == 0u) STORE(next_start, i, result);
  }
  if (kMeasure) SUM_PARTIALS(sums, vec4(dot(change, change), 0.0, 0.0, 0.0));
}
