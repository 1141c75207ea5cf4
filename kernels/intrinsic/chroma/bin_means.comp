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

void main() {
  int i = int(gl_GlobalInvocationID.x), weight = 0, total = 0;
  if (i >= kBins * kBins) return;
  for (int table = 0; table < kTables; ++table) {
    weight += int(FETCH1(weights, i * kTables + table));
    total += int(LOAD(totals, i * kTables + table));
    STORE(totals, i * kTables + table, 0u);
  }
  STORE(means, uint(i), weight > 0 ? kMaxReflectance * float(total) / float(weight) : kEmptyBin);
}
