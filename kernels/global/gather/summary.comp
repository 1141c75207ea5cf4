// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "global/model/model.glsl"

// One workgroup: every base color's part of the frame's mean color, and its share of the points.
PLANE_IN(0, colors);
WORD_IN(1, labels);
PLANE_OUT(2, means);  // kSlots
layout(push_constant) uniform Push { SIZES } push;

void main() {
  int count = push.grid.x * push.grid.y;
  vec4 part[kSlots];
  for (int k = 0; k < kSlots; ++k) part[k] = vec4(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < count; i += int(gl_WorkGroupSize.x)) {
    vec4 color = FETCH(colors, i);
    int label = int(FETCH1(labels, i));
    for (int k = 0; k < kSlots; ++k)
      if (k == label) part[k] += vec4(color.rgb, 1.0);
  }
  for (int k = 0; k < kSlots; ++k) {
    vec4 sum = workgroup_sum(part[k]) / float(count);
    if (gl_LocalInvocationID.x == 0u) STORE(means, k, sum);
  }
}
