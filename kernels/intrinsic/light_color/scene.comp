// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "light.glsl"

// The scene's light from a frame's points. One workgroup.
PLANE_IN(0, points);
PLANE_INOUT(1, light);
layout(push_constant) uniform Push {
  uint count;   // of points
  uint first;   // 1: there is no frame before
  float slope;
} push;

const uint kBins = 256u;
const float kLow = -6.3, kHigh = 1.7;   // m of the first and last bin
const float kBright = 0.95;             // quantile of m
const float kRate = 1.0 / 16.0;         // share of the newest frame

shared uint counts[kBins];

void main() {
  uint lane = gl_LocalInvocationID.x, lanes = gl_WorkGroupSize.x;
  for (uint i = lane; i < kBins; i += lanes) counts[i] = 0u;
  barrier();
  for (uint i = lane; i < push.count; i += lanes) {
    float place = (FETCH(points, int(i)).x - kLow) * (float(kBins) / (kHigh - kLow));
    atomicAdd(counts[uint(clamp(place, 0.0, float(kBins - 1u)))], 1u);
  }
  barrier();
  if (lane > 0u) return;
  uint above = uint((1.0 - kBright) * float(push.count)), bin = kBins - 1u;
  for (uint sum = counts[bin]; sum <= above && bin > 0u; sum += counts[bin]) --bin;
  float bright = kLow + (float(bin) + 0.5) * ((kHigh - kLow) / float(kBins));
  vec4 before = LOAD(light, LIGHT_NOW);
  bool known = push.first == 0u && before.w > 0.0;
  STORE(light, LIGHT_NOW, vec4(push.slope, known ? mix(before.y, bright, kRate) : bright, 1.0, 1.0));
}
