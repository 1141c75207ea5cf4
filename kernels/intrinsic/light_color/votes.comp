// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "light.glsl"

// The network's first layer: a convolution along the slopes. One value an invocation.
SCALAR_IN(0, features);
SCALAR_IN(1, weights);
SCALAR_OUT(2, hidden);

void main() {
  int i = int(line_index());
  if (i >= NET_HIDDEN) return;
  int channel = i / STEP_SLOPES, place = i % STEP_SLOPES;
  int from = max(0, NET_TAPS / 2 - place), to = min(NET_TAPS, STEP_SLOPES + NET_TAPS / 2 - place);
  float sum = FETCH1(weights, NET_A_BIAS + channel);
  for (int k = 0; k < STEP_CHANNELS; ++k) {
    int weight = NET_A + (channel * STEP_CHANNELS + k) * NET_TAPS, feature = k * STEP_SLOPES + place - NET_TAPS / 2;
    for (int t = from; t < to; ++t) sum += FETCH1(weights, weight + t) * FETCH1(features, feature + t);
  }
  STORE(hidden, i, leaky(sum));
}
