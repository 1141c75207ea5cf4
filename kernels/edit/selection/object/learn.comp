// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "object.glsl"

// Moves a density of colors toward a histogram, and finds its largest value: totals.y. A histogram of nothing changes nothing.
// One workgroup.
SCALAR_IN(0, histogram);
SCALAR_INOUT(1, model);
PLANE_OUT(2, totals);
layout(push_constant) uniform Push {
  int first;   // of the density, in `model`
  int total;   // its place in `totals`
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
    float before = push.rate < 1.0 ? LOAD(model, push.first + n) : 0.0;
    float now = sum > 0.0 ? before + push.rate * (FETCH1(histogram, n) / sum - before) : before;
    STORE(model, push.first + n, now);
    top = max(top, now);
  }
  largest[lane] = top;
  barrier();
  if (lane != 0) return;
  for (int i = 1; i < stride; ++i) top = max(top, largest[i]);
  STORE(totals, push.total, vec4(sum, top, 0.0, 0.0));
}
