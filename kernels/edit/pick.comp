// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "edit.glsl"

// The mean of the pixels within two of one. One invocation.
PLANE_IN(0, plane);
PLANE_OUT(1, color);  // one vec4
layout(push_constant) uniform Push {
  ivec2 size;
  ivec2 at;
} push;

void main() {
  if (gl_GlobalInvocationID.x > 0u) return;
  ivec2 first = max(push.at - 2, ivec2(0)), last = min(push.at + 2, push.size - 1);
  vec4 sum = vec4(0.0);
  float count = 0.0;
  for (int y = first.y; y <= last.y; ++y)
    for (int x = first.x; x <= last.x; ++x) {
      sum += finite(FETCH(plane, y * push.size.x + x));
      count += 1.0;
    }
  STORE(color, 0, sum / max(count, 1.0));
}
