#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"
#define TABLE_SLOT 0
#include "table.glsl"

// Reflectance with the mean of the shading, (R, |S|), and the direct light, (T_0, T_0, T_0, 1).
PLANE_IN(1, state);
PLANE_OUT(2, intrinsic);
PLANE_OUT(3, direct);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int plane = push.size.x * push.size.y;
  int n = at.y * push.size.x + at.x;
  vec4 x = FETCH(state, n);
  float light = max(x.w, 0.0);
  vec3 s = vec3(light);
  for (int g = 1; g <= kGroups; ++g) s += (base_colors(g) * max(FETCH(state, g * plane + n), 0.0)).rgb;
  STORE(intrinsic, n, vec4(exp(x.rgb), (s.r + s.g + s.b) * (1.0 / 3.0)));
  STORE(direct, n, vec4(vec3(light), 1.0));
}
