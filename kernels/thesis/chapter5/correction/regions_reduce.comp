// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Marked regions of a smaller frame: those of the fine pixel in the middle of each `factor`² of them.
layout(push_constant) uniform Push {
  ivec2 size;
  ivec2 fine_size;
  int factor;
} push;
PLANE_IN(0, fine);
PLANE_OUT(1, coarse);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  ivec2 from = min(at * push.factor + push.factor / 2, push.fine_size - 1);
  STORE(coarse, at.y * push.size.x + at.x, FETCH(fine, from.y * push.fine_size.x + from.x));
}
