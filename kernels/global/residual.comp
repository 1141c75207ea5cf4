#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "global.glsl"

// What the grid's chroma has beyond tint and base color, and how far it is believed. One point an invocation.
PLANE_IN(0, cues);
PLANE_IN(1, lit);
WORD_IN(2, labels);
PLANE_IN(3, base);
PLANE_IN(4, scene);
PLANE_OUT(5, residual);  // e, belief, 1
layout(push_constant) uniform Push { uint count; } push;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  vec4 light = FETCH(lit, int(i));
  vec2 e = FETCH(cues, int(i)).xy - light.xy - FETCH(base, int(FETCH1(labels, int(i)))).xy;
  STORE(residual, i, vec4(e, belief(e, light.z, FETCH(scene, SCENE_STATISTICS).x), 1.0));
}
