// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/noise.glsl"

// Smooths a depth image within surfaces by a bilateral filter of 5 × 5 pixels (Tomasi and Manduchi 1998), as its noise is. One pixel
// an invocation.
SCALAR_IN(0, depth);  // meters; 0: unknown
SCALAR_OUT(1, smoothed);
layout(push_constant) uniform Push {
  uvec2 size;
} push;

const float kFarthest = 100.0;  // meters: what is beyond is not known, nor infinity
const int kReach = 2;
const float kSigma = 1.5;     // pixels
const float kSteps = 2.5;     // noises that two pixels of one surface differ by

void main() {
  uint line = line_index();
  ivec2 at = ivec2(line % push.size.x, line / push.size.x);
  if (at.y >= int(push.size.y)) return;
  float z = FETCH1(depth, int(line)), sigma = kSteps * noise_at(z), sum = 0.0, total = 0.0;
  for (int dy = -kReach; dy <= kReach; ++dy)
    for (int dx = -kReach; dx <= kReach; ++dx) {
      ivec2 from = clamp(at + ivec2(dx, dy), ivec2(0), ivec2(push.size) - 1);
      float other = FETCH1(depth, from.y * int(push.size.x) + from.x), step = (other - z) / sigma;
      float weight = other > 0.0 && other < kFarthest ? exp(-0.5 * (float(dx * dx + dy * dy) / (kSigma * kSigma) + step * step)) : 0.0;
      sum += weight > 0.0 ? weight * other : 0.0;
      total += weight;
    }
  STORE(smoothed, line, z > 0.0 && z < kFarthest ? sum / total : 0.0);
}
