#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "global.glsl"

// Every point's base color, by the chroma that the last known tint leaves; all the same on a first look. One point an invocation.
PLANE_IN(0, cues);
PLANE_IN(1, lit);  // t of the last look
WORD_IN(2, table);
PLANE_IN(3, scene);
WORD_OUT(4, labels);
layout(push_constant) uniform Push {
  uint count;
  uint look;
} push;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  uint label = 0u;
  if (push.look > 0u || FETCH(scene, SCENE_STATE).x == 0.0)
    label = FETCH1(table, int(bin_at(FETCH(cues, int(i)).xy - FETCH(lit, int(i)).xy)));
  STORE(labels, i, label);
}
