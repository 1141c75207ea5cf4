#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "model.glsl"
#include "residual.glsl"

// What the chroma of the grid's points has beyond tint and base color, and how far that is believed to be light.
PLANE_IN(0, points);
PLANE_IN(1, tints);
WORD_IN(2, labels);
PLANE_IN(3, scene);
PLANE_OUT(4, raw);  // residual, belief
layout(push_constant) uniform Push {
  int count;
  float trust, trust_tint;
} push;

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= push.count) return;
  vec4 tint = FETCH(tints, i);
  vec2 off = FETCH(points, i).xy - tint.xy;
  if (FETCH(scene, SCENE_AMOUNT).w > 1.5) off -= FETCH(scene, SCENE_COLORS + int(FETCH1(labels, i))).xy;
  STORE(raw, i, vec4(off, belief(off, tint.z, FETCH(scene, SCENE_TINT).x, push.trust, push.trust_tint), 0.0));
}
