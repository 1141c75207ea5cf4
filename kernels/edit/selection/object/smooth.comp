// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "object.glsl"

// A histogram smoothed by 1/4, 1/2, 1/4 along each axis.
layout(constant_id = 1) const bool COUNTS = false;  // reads whole numbers
WORD_IN(0, counts);
SCALAR_IN(1, before);
SCALAR_OUT(2, smoothed);

void main() {
  int n = int(line_index());
  if (n >= kBinCount) return;
  ivec3 at = ivec3(n / (kBins.y * kBins.z), n / kBins.z % kBins.y, n % kBins.z);
  float sum = 0.0;
  for (int x = max(at.x - 1, 0); x <= min(at.x + 1, kBins.x - 1); ++x)
    for (int y = max(at.y - 1, 0); y <= min(at.y + 1, kBins.y - 1); ++y)
      for (int z = max(at.z - 1, 0); z <= min(at.z + 1, kBins.z - 1); ++z) {
        int from = (x * kBins.y + y) * kBins.z + z;
        float value = COUNTS ? float(FETCH1(counts, from)) : FETCH1(before, from);
        sum += value * exp2(-float(abs(x - at.x) + abs(y - at.y) + abs(z - at.z)) - 3.0);
      }
  STORE(smoothed, n, sum);
}
