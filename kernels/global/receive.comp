#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "global.glsl"

// Indirect light E0, up to the scene's amount, that a surface of every base color receives: what the others send, less its own. One
// point an invocation.
PLANE_IN(0, blurred);
PLANE_IN(1, scene);
PLANE_OUT(2, received);
layout(push_constant) uniform Push {
  uint count;
  float near;
  float own;
} push;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  vec4 all = vec4(0.0);
  for (uint k = 0u; k < kSlots; ++k) all += FETCH(blurred, int(k * push.count + i));
  vec3 far = (1.0 - push.near) * FETCH(scene, SCENE_MEAN).rgb;
  for (uint k = 0u; k < kSlots; ++k) {
    vec4 others = all - push.own * FETCH(blurred, int(k * push.count + i));
    STORE(received, k * push.count + i, vec4(push.near * others.rgb / (others.w + 0.02) + far, 0.0));
  }
}
