// SPDX-License-Identifier: LGPL-2.1-or-later
// Histograms in fixed point, so that sums do not depend on order. A point's weight is at most about 1, and there are at most
// 40 x 40 points.
const float kCountUnit = 65536.0;

uint counted(float value) { return uint(value * kCountUnit + 0.5); }

// Adds a weight to the four bins around a chroma, as hat functions say.
#define COUNT(counts, base, chroma, weight)                                         \
  {                                                                                 \
    vec2 place = clamp(place_of(chroma), vec2(0.0), vec2(float(kBins) - 1.001));    \
    vec2 low = floor(place), share = place - low;                                   \
    int bin = (base) + int(low.y) * kBins + int(low.x);                             \
    atomicAdd(LOAD(counts, bin), counted((weight) * (1.0 - share.x) * (1.0 - share.y)));     \
    atomicAdd(LOAD(counts, bin + 1), counted((weight) * share.x * (1.0 - share.y)));         \
    atomicAdd(LOAD(counts, bin + kBins), counted((weight) * (1.0 - share.x) * share.y));     \
    atomicAdd(LOAD(counts, bin + kBins + 1), counted((weight) * share.x * share.y));         \
  }
