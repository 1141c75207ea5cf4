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
  float expected = push.continues > 0.0 ? LOAD(cut_decision, 1).x : 0.0;
  vec4 decision;
  float mismatch = sum.x / push.cells;
  bool sudden = frames >= SUDDEN_FRAMES && mismatch >= max(SUDDEN_SHARE * push.cut_fraction, SUDDEN_RATIO * expected);
  decision[CUT_MISMATCH] = mismatch;
  decision[CUT_ANCHORED] = mismatch < push.cut_fraction && !sudden ? 1.0 : 0.0;
  decision[CUT_MOVED] = sum.y / max(sum.z, 1e-20);
  decision[CUT_FRAMES] = decision[CUT_ANCHORED] * min(frames + 1.0, 1e6);
  STORE(cut_decision, 0, decision);
  STORE(cut_decision, 1, vec4(decision[CUT_ANCHORED] * max(mismatch, EXPECTED_FADE * expected), 0.0, 0.0, 0.0));
}
