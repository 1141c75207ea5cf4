// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#include "gpu/workgroup_sum.glsl"
#include "search.glsl"

// One workgroup: whether a step is taken as it is, by the energy without samples. A step is linear in what the data term
// is not; if light spans decades it may overshoot by far, and is shortened then, at most twice before it is rejected.
// The penalty of negative light bounds nothing (energy.glsl): what a step adds of it falls in the steps after, and holding
// it down slows them. Samples are in no bound either, as they follow the reflectance: with them a step may raise the energy
// by kSamples, but no step to more than that above where the frame starts.
PLANE_IN(0, first);
PLANE_IN(1, second);
SCALAR_INOUT(2, search);
WORD_OUT(3, rescale);  // 1: the step is to be scaled by SEARCH_FACTOR

// Modes: x is the start of the frame, follows a step, follows one shortened once, or twice.
const int kStart = 0, kStep = 1, kShortened = 2, kLast = 3;

const float kRounding = 1e-5;
const float kSamples = 0.05;
const float kShorter = 0.25;

void main() {
  vec4 a = vec4(0.0), b = vec4(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < push.count; i += int(gl_WorkGroupSize.x)) {
    a += FETCH(first, i);
    b += FETCH(second, i);
  }
  a = workgroup_sum(a);
  b = workgroup_sum(b);
  if (gl_LocalInvocationID.x != 0u) return;
  float rest = a.x + a.y + a.z + b.x + b.y + b.z;
  float before = LOAD(search, SEARCH_ENERGY);
  float bound = before * (1.0 + kRounding);
  if (push.samples > 0) bound = max(bound, min(before, LOAD(search, SEARCH_START)) * (1.0 + kSamples));
  // Not by what is larger, so that what is not a number is refused.
  bool good = push.mode == kStart || rest <= bound;
  STORE(search, SEARCH_ENERGY, good ? rest + b.w : before);
  STORE(search, SEARCH_FACTOR, good ? 1.0 : (push.mode == kLast ? 0.0 : kShorter));
  float shortened = push.mode == kStart ? 0.0 : LOAD(search, SEARCH_SHORTENED);
  STORE(search, SEARCH_SHORTENED, shortened + (push.mode == kStep && !good ? 1.0 : 0.0));
  if (push.mode == kStart) STORE(search, SEARCH_START, rest + b.w);
  STORE(rescale, 0, good ? 0u : 1u);
}
