// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "bins.glsl"

// Sums to means, and the sums back to 0 for the next splat. One bin an invocation.
layout(constant_id = 1) const int kTables = 1;  // as in bin_splat.comp
WORD_IN(0, weights);
WORD_INOUT(1, totals);
SCALAR_OUT(2, means);

// Low and high word.
void add(inout uvec2 sum, uvec2 more) {
  uint carry;
  sum.x = uaddCarry(sum.x, more.x, carry);
  sum.y += more.y + carry;
}
float value(uvec2 sum) {
  bool negative = int(sum.y) < 0;
  if (negative) {
    sum = ~sum;
    add(sum, uvec2(1u, 0u));
  }
  float size = 4294967296.0 * float(sum.y) + float(sum.x);
  return negative ? -size : size;
}

void main() {
  int i = int(line_index());
  if (i >= kBins * kBins) return;
  uvec2 weight = uvec2(0u), total = uvec2(0u);
  for (int table = 0; table < kTables; ++table) {
    int low = i * kTables + table, high = low + kBins * kBins * kTables;
    add(weight, uvec2(FETCH1(weights, low), FETCH1(weights, high)));
    add(total, uvec2(LOAD(totals, low), LOAD(totals, high)));
    STORE(totals, low, 0u);
    STORE(totals, high, 0u);
  }
  STORE(means, uint(i), weight == uvec2(0u) ? kEmptyBin : kMaxReflectance * (value(total) / value(weight)));
}
