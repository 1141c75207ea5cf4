#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "global.glsl"

// E0 and shading at every point of the grid. One point an invocation.
PLANE_IN(0, points);
PLANE_IN(1, cues);
WORD_IN(2, labels);  // of the frame before
PLANE_IN(3, received);
PLANE_IN(4, scene);
PLANE_OUT(5, lights);  // E0, shading
layout(push_constant) uniform Push { uvec2 size; } push;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.size.x * push.size.y) return;
  uvec2 half_size = (push.size + 1u) / 2u;
  bool anew = FETCH(scene, SCENE_STATE).x > 0.0;
  uint label = anew ? 0u : FETCH1(labels, int(i));
  vec4 shares;
  ivec4 around = points_around(place_of(i, push.size.x), 2u, half_size, shares) +
                 int(label * half_size.x * half_size.y);
  float shading = anew ? FETCH(cues, int(i)).w : FETCH(points, int(i)).w;
  STORE(lights, i, vec4(BLEND(received, around, shares).rgb, shading));
}
