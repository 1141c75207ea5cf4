#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Points that are of no object, or of another one than the one that is followed, lose their probability.
PLANE_INOUT(0, probability);
WORD_IN(1, foreign);  // not 0: such a point
layout(push_constant) uniform Push { int count; } push;

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i < push.count && FETCH1(foreign, i) != 0u) STORE(probability, 1 + i, vec4(0.0));
}
