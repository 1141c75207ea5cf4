// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#include "gpu/workgroup_sum.glsl"

// One workgroup: whether a step is taken as it is, by the energy without samples. A step is linear in what the data term
// is not; where light spans decades it may overshoot by far, and is shortened then, twice at most before it is not taken.
// The penalty of negative light bounds nothing (energy.glsl): what a step adds of it falls in the steps after, and holding
// it down slows them. Samples are in no bound either, as they follow the reflectance: with them a step may raise the energy
// by kSamples, but no step to more than that above where the frame starts.
// mode 0: x is where the frame starts. 1: after a step. 2: after a shortened one. 3: after the last one.
// `search` is (energy, factor that the step is to be shortened by, shortened steps of the frame, energy where it starts).
PLANE_IN(0, first);
PLANE_IN(1, second);
SCALAR_INOUT(2, search);
WORD_OUT(3, shorten);

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
  float before = LOAD(search, 0);
  float most = before * (1.0 + kRounding);
  if (push.samples > 0) most = max(most, min(before, LOAD(search, 3)) * (1.0 + kSamples));
  // Not by what is larger, so that what is not a number is refused.
  bool good = push.mode == 0 || rest <= most;
  STORE(search, 0, good ? rest + b.w : before);
  STORE(search, 1, good ? 1.0 : (push.mode == 3 ? 0.0 : kShorter));
  STORE(search, 2, push.mode == 0 ? 0.0 : LOAD(search, 2) + (push.mode == 1 && !good ? 1.0 : 0.0));
  if (push.mode == 0) STORE(search, 3, rest + b.w);
  STORE(shorten, 0, good ? 0u : 1u);
}
