#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "global.glsl"

// The base color of the grid's points, what their chroma has beyond it and the tint, and how far that is believed. One point an invocation.
PLANE_IN(0, cues);
PLANE_IN(1, lit);
WORD_IN(2, table);
PLANE_IN(3, base);
PLANE_IN(4, scene);
PLANE_OUT(5, residual);  // e, belief
WORD_OUT(6, labels);
layout(push_constant) uniform Push { uint count; } push;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  vec4 light = FETCH(lit, int(i));
  vec2 left = FETCH(cues, int(i)).xy - light.xy;
  uint label = FETCH1(table, int(bin_at(left)));
  vec2 e = left - FETCH(base, int(label)).xy;
  STORE(labels, i, label);
  STORE(residual, i, vec4(e, belief(e, light.z, FETCH(scene, SCENE_STATISTICS).x), 0.0));
}
