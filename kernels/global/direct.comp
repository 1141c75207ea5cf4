#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "model.glsl"

// What share of light is direct and white, T0 / S: what the indirect light leaves of it, at most its weakest channel; its color is then the lamps', too. And
// how bright reflectance is, for the next frame.
PLANE_IN(0, frame);  // without tint
PLANE_IN(1, intrinsic);
PLANE_IN(2, scene);
PLANE_INOUT(3, light);
SCALAR_OUT(4, memory);
layout(push_constant) uniform Push { ivec2 size; } push;

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  vec3 lit = sanitize(FETCH(frame, n).rgb) + kIntensityFloor;
  float shading = FETCH(intrinsic, n).w;
  STORE(memory, n, log(lit.r * lit.g * lit.b) * (1.0 / 3.0) - log(max(shading, 1e-6)));
  vec4 own = LOAD(light, n);
  float direct = max(shading * mean3(own.rgb) - own.w, 0.0) / max(shading, 1e-12);
  vec3 white = color_of(FETCH(scene, SCENE_WHITE).xy);
  STORE(light, n, vec4(white * own.rgb, min(min(direct, 1.0), min(min(own.r, own.g), own.b))));
}
