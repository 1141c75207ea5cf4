// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Decides whether a frame continues the one before. One workgroup of 64.
//   cut_decision[0] = mean mismatch of the frame, 1 if it is anchored or 0 at a cut, the share of the picture's structure that
//                moved, number of frames anchored since the last cut or reset
PLANE_IN(0, sums);
PLANE_INOUT(1, cut_decision);
layout(push_constant) uniform Push {
  uint count;
  float cells;
  float cut_fraction;
  float continues;  // 1, or 0 for the first frame that has one before
} push;

shared vec4 totals[64];

void main() {
  uint lane = gl_LocalInvocationID.x;
  vec4 sum = vec4(0.0);
  for (uint i = lane; i < push.count; i += 64u) sum += FETCH(sums, int(i));
  totals[lane] = sum;
  barrier();
  if (lane > 0u) return;
  for (uint i = 1u; i < 64u; ++i) sum += totals[i];
  float mean = sum.x / push.cells, anchored = mean < push.cut_fraction ? 1.0 : 0.0;
  float frames = push.continues > 0.0 ? LOAD(cut_decision, 0).w : 0.0;
  STORE(cut_decision, 0, vec4(mean, anchored, sum.y / max(sum.z, 1e-20), anchored * min(frames + 1.0, 1e6)));
}
