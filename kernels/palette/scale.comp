// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "palette.glsl"

// One workgroup: the quantile of ln R and the scale from it; clears the counts.
WORD_INOUT(0, counts);
SCALAR_INOUT(1, scale);

shared uint sums[256];

void main() {
  int lane = int(gl_LocalInvocationID.x);
  int share = kScaleBins / int(gl_WorkGroupSize.x);
  uint sum = 0u;
  for (int i = 0; i < share; ++i) sum += LOAD(counts, lane * share + i);
  sums[lane] = sum;
  barrier();
  if (lane == 0) {
    float target = push.white_quantile * 3.0 * float(push.size.x * push.size.y);
    uint below = 0u;
    int chunk = 0;
    while (chunk + 1 < int(gl_WorkGroupSize.x) && float(below + sums[chunk]) < target) below += sums[chunk++];
    int bin = chunk * share;
    uint count = LOAD(counts, bin);
    while (bin + 1 < kScaleBins && (count == 0u || float(below + count) < target)) {
      below += count;
      count = LOAD(counts, ++bin);
    }
    float position = float(bin) + (target - float(below)) / float(max(count, 1u));
    float wanted = log(push.white_level) - (position * (32.0 / float(kScaleBins)) - 16.0);
    float before = push.first == 1 ? wanted : LOAD(scale, 0);
    STORE(scale, 0, before + push.decay * (wanted - before));
  }
  barrier();
  for (int i = 0; i < share; ++i) STORE(counts, lane * share + i, 0u);
}
