// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "light.glsl"

// The rest of the network, and what the scene's k is then: the mean of the candidates, each with the probability that the averaged
// votes give it. One workgroup.
SCALAR_IN(0, hidden);
SCALAR_IN(1, weights);
SCALAR_IN(2, cloud);
PLANE_INOUT(3, light);
layout(push_constant) uniform Push { float rate; } push;  // least share of the newest measurement

shared float second[NET_HIDDEN], dense[NET_DENSE], votes[CANDIDATES];

void main() {
  int lane = int(gl_LocalInvocationID.x), lanes = int(gl_WorkGroupSize.x);
  for (int i = lane; i < NET_HIDDEN; i += lanes) {
    int channel = i / STEP_SLOPES, place = i % STEP_SLOPES;
    int from = max(0, NET_TAPS / 2 - place), to = min(NET_TAPS, STEP_SLOPES + NET_TAPS / 2 - place);
    float sum = FETCH1(weights, NET_B_BIAS + channel);
    for (int k = 0; k < NET_WIDTH; ++k)
      for (int t = from; t < to; ++t)
        sum += FETCH1(weights, NET_B + (channel * NET_WIDTH + k) * NET_TAPS + t) *
               FETCH1(hidden, k * STEP_SLOPES + place - NET_TAPS / 2 + t);
    second[i] = leaky(sum);
  }
  for (int i = lane; i < NET_DENSE; i += lanes) {
    float sum = FETCH1(weights, NET_D_BIAS + i) + FETCH1(weights, NET_CLOUD_BIAS + i);
    for (int k = 0; k < NET_HIDDEN; ++k) sum += FETCH1(weights, NET_D + i * NET_HIDDEN + k) * FETCH1(hidden, k);
    for (int k = 0; k < CLOUD_COUNT; ++k)
      sum += FETCH1(weights, NET_CLOUD + i * CLOUD_COUNT + k) * log(1.0 + 0.3 * 1000.0 * FETCH1(cloud, k));
    dense[i] = leaky(sum);
  }
  barrier();
  for (int i = lane; i < CANDIDATES; i += lanes) {
    float sum = FETCH1(weights, NET_C_BIAS) + FETCH1(weights, NET_E_BIAS + i);
    int place = i + (STEP_SLOPES - CANDIDATES) / 2;
    for (int k = 0; k < NET_WIDTH; ++k) sum += FETCH1(weights, NET_C + k) * second[k * STEP_SLOPES + place];
    for (int k = 0; k < NET_DENSE; ++k) sum += FETCH1(weights, NET_E + i * NET_DENSE + k) * dense[k];
    votes[i] = sum;
  }
  barrier();
  if (lane > 0) return;
  vec4 target = LOAD(light, LIGHT_TARGET);
  bool fresh = target.z == 0.0;
  float share = max(push.rate, 1.0 / (target.z + 1.0)), top = -1e30;
  for (int i = 0; i < CANDIDATES; ++i) {
    float vote = mix(fresh ? 0.0 : LOAD(light, LIGHT_VOTES + i / 4)[i & 3], votes[i], share);
    LOAD(light, LIGHT_VOTES + i / 4)[i & 3] = vote;
    top = max(top, vote);
  }
  vec3 sum = vec3(0.0);
  for (int i = 0; i < CANDIDATES; ++i) {
    float k = candidate(i);
    sum += exp(LOAD(light, LIGHT_VOTES + i / 4)[i & 3] - top) * vec3(1.0, k, k * k);
  }
  float mean = sum.y / sum.x, variance = max(sum.z / sum.x - mean * mean, 0.0);
  STORE(light, LIGHT_TARGET, vec4(mean, sqrt(variance), target.z + 1.0, target.w));
}
