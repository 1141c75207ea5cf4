// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Every pixel is its own component.
WORD_OUT(0, roots);
layout(push_constant) uniform Push { ivec2 size; } push;

void main() {
  if (gl_GlobalInvocationID.x >= uint(push.size.x)) return;
  uint n = gl_GlobalInvocationID.y * uint(push.size.x) + gl_GlobalInvocationID.x;
  STORE(roots, n, n);
}
