#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"

// The layers in linear light, R = exp(r + gauge), S = exp(s − gauge).
PLANE_IN(0, solution);
SCALAR_IN(1, gauge);
PLANE_OUT(2, layers);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  float g = FETCH1(gauge, 0);
  STORE(layers, n, exp(min(FETCH(solution, n) + vec4(g, g, g, -g), 60.0)));
}
