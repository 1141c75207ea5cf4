// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "palette.glsl"

// One workgroup: lists the bins with pixels, in order: (mean color, pixels).
PLANE_IN(0, histogram);
PLANE_OUT(1, list);
WORD_OUT(2, list_length);

shared uint sums[256];

void main() {
  int lane = int(gl_LocalInvocationID.x);
  int share = (kBinCount - 1) / int(gl_WorkGroupSize.x) + 1;
  int first = lane * share;
  int last = min(first + share, kBinCount);
  uint used = 0u;
  for (int n = first; n < last; ++n) used += FETCH(histogram, n).x > 0.0 ? 1u : 0u;
  sums[lane] = used;
  barrier();
  uint at = 0u;
  for (int i = 0; i < lane; ++i) at += sums[i];
  if (lane + 1 == int(gl_WorkGroupSize.x)) STORE(list_length, 0, at + used);
  for (int n = first; n < last; ++n) {
    vec4 bin = FETCH(histogram, n);
    if (bin.x > 0.0) STORE(list, at++, vec4(bin.yzw / bin.x, bin.x));
  }
}
