// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "global/model/model.glsl"

// Light that a surface of base color j receives around a coarse point, up to the scene's amount: the blurred light there and, in
// part, the mean of the frame; its own color counts less, since a plane does not light itself. And the number of emitters.
PLANE_IN(0, blurred);
PLANE_IN(1, means);
PLANE_OUT(2, received);
layout(push_constant) uniform Push {
  SIZES
  float near, own;
} push;

const float kMinNumber = 0.02;

void main() {
  int i = int(line_index()), count = push.coarse.x * push.coarse.y, slot = i / count, j = i - slot * count;
  if (slot >= kSlots) return;
  vec4 all = vec4(0.0);
  vec3 frame = vec3(0.0);
  for (int k = 0; k < kSlots; ++k) {
    vec4 part = FETCH(means, k);
    frame += part.rgb;
    if (part.w > 0.0) all += FETCH(blurred, k * count + j);
  }
  all -= push.own * FETCH(blurred, i);
  float number = all.w + kMinNumber;
  STORE(received, i, vec4(push.near / number * all.rgb + (1.0 - push.near) * frame, number));
}
