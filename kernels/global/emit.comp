#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "global.glsl"

// Light that the surfaces of every base color send, and how many they are, on a grid of half the points. One of its points for one
// base color an invocation.
PLANE_IN(0, points);
WORD_IN(1, labels);  // of the frame before
PLANE_IN(2, scene);
PLANE_OUT(3, emitted);
layout(push_constant) uniform Push { uvec2 size; } push;  // of the grid

void main() {
  uvec2 half_size = (push.size + 1u) / 2u;
  uint count = half_size.x * half_size.y, i = gl_GlobalInvocationID.x;
  if (i >= kSlots * count) return;
  uint slot = i / count;
  uvec2 from = 2u * place_of(i % count, half_size.x), to = min(from + 2u, push.size);
  bool anew = FETCH(scene, SCENE_STATE).x > 0.0;
  vec4 sum = vec4(0.0);
  for (uint y = from.y; y < to.y; ++y)
    for (uint x = from.x; x < to.x; ++x) {
      int at = int(y * push.size.x + x);
      if ((anew ? 0u : FETCH1(labels, at)) == slot) sum += vec4(FETCH(points, at).rgb, 1.0);
    }
  STORE(emitted, i, sum / float((to.x - from.x) * (to.y - from.y)));
}
