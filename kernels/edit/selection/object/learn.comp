// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "object.glsl"

// Moves a density of colors toward a histogram, or raises it to that, and finds its largest value: totals.y. A histogram of nothing
// changes nothing. One workgroup.
layout(constant_id = 1) const bool RAISE = false;
SCALAR_IN(0, histogram);
SCALAR_INOUT(1, model);
PLANE_OUT(2, totals);
layout(push_constant) uniform Push {
  int density;
  float rate;  // 1: it becomes the histogram
} push;

shared float largest[256];

void main() {
  int lane = int(gl_LocalInvocationID.x), stride = int(gl_WorkGroupSize.x);
  float sum = 0.0;
  for (int n = lane; n < kBinCount; n += stride) sum += FETCH1(histogram, n);
  sum = workgroup_sum(vec4(sum)).x;
  float top = 0.0;
  for (int n = lane; n < kBinCount; n += stride) {
    int at = push.density * kBinCount + n;
    float before = LOAD(model, at), share = sum > 0.0 ? FETCH1(histogram, n) / sum : before;
    float now = RAISE ? max(before, share) : push.rate < 1.0 ? before + push.rate * (share - before) : share;
    STORE(model, at, now);
    top = max(top, now);
  }
  largest[lane] = top;
  barrier();
  if (lane != 0) return;
  for (int i = 1; i < stride; ++i) top = max(top, largest[i]);
  STORE(totals, push.density, vec4(sum, top, 0.0, 0.0));
}
