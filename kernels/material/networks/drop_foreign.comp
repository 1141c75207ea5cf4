// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Sets the probability to 0 at points of no object or of an object that is not tracked.
PLANE_INOUT(0, probability);
WORD_IN(1, foreign);  // not 0: such a point
layout(push_constant) uniform Push { int count; } push;

void main() {
  int i = int(line_index());
  if (i < push.count && FETCH1(foreign, i) != 0u) STORE(probability, 1 + i, vec4(0.0));
}
