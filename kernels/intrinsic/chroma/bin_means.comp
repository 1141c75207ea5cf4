// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "bins.glsl"

// Adds the tables of every bin up, with kWeights to its weight, else to the weighted mean of r, and clears them. One bin an invocation.
layout(constant_id = 1) const bool kWeights = false;
layout(constant_id = 2) const int kTables = 1;  // as in bin_splat.comp
WORD_INOUT(0, sums);
SCALAR_IN(1, weights);
SCALAR_OUT(2, values);

void main() {
  int i = int(line_index());
  if (i >= kBins * kBins) return;
  uint low = 0u, high = 0u, carry;
  for (int table = 0; table < kTables; ++table) {
    int at = i * kTables + table, high_at = at + kBins * kBins * kTables;
    low = uaddCarry(low, LOAD(sums, at), carry);
    high += LOAD(sums, high_at) + carry;
    STORE(sums, at, 0u);
    STORE(sums, high_at, 0u);
  }
  float sum = 4294967296.0 * float(high) + float(low), weight = kWeights ? 1.0 : FETCH1(weights, i);
  STORE(values, uint(i), kWeights ? sum : weight > 0.0 ? kMaxReflectance * (2.0 * (sum / weight) - 1.0) : kEmptyBin);
}
