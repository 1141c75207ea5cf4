// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "temporal.glsl"

// Decides whether a frame continues the one before (temporal.glsl). One workgroup of kSumLanes.
PLANE_IN(0, sums);
PLANE_INOUT(1, cut_decision);
layout(push_constant) uniform Push {
  uint count;
  float cells;
  float cut_fraction;
  float continues;  // 1, or 0 for the first frame that has one before
} push;

const uint kSumLanes = 64u;
shared vec4 totals[kSumLanes];

void main() {
  uint lane = gl_LocalInvocationID.x;
  vec4 sum = vec4(0.0);
  for (uint i = lane; i < push.count; i += kSumLanes) sum += FETCH(sums, int(i));
  totals[lane] = sum;
  barrier();
  if (lane > 0u) return;
  for (uint i = 1u; i < kSumLanes; ++i) sum += totals[i];
  float frames = push.continues > 0.0 ? LOAD(cut_decision, 0)[CUT_FRAMES] : 0.0;
  vec4 decision;
  decision[CUT_MISMATCH] = sum.x / push.cells;
  decision[CUT_ANCHORED] = decision[CUT_MISMATCH] < push.cut_fraction ? 1.0 : 0.0;
  decision[CUT_MOVED] = sum.y / max(sum.z, 1e-20);
  decision[CUT_FRAMES] = decision[CUT_ANCHORED] * min(frames + 1.0, 1e6);
  STORE(cut_decision, 0, decision);
}
