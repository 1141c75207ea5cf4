#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "bins.glsl"

// Sums to means, four at a time so that a pixel reads its four bins at once: (x, y), (x + 1, y), (x, y + 1),
// (x + 1, y + 1). One bin an invocation.
WORD_IN(0, weights);
WORD_IN(1, totals);
PLANE_OUT(2, means);

float mean(uint x, uint y) {
  int at = int(min(y, uint(kBins) - 1u) * uint(kBins) + min(x, uint(kBins) - 1u));
  int weight = int(FETCH1(weights, at));
  return weight > 0 ? kMostReflectance * float(int(FETCH1(totals, at))) / float(weight) : kEmptyBin;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= uint(kBins * kBins)) return;
  uint y = i / uint(kBins), x = i - y * uint(kBins);
  STORE(means, i, vec4(mean(x, y), mean(x + 1u, y), mean(x, y + 1u), mean(x + 1u, y + 1u)));
}
