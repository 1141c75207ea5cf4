#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Takes layers along that are not written anew when the output's scale moves. In place, one pixel an invocation.
PLANE_IN(0, gauge);  // .w = how much ln c moved (gauge.comp)
PLANE_IN(1, before);
PLANE_OUT(2, intrinsic);  // the same buffer
layout(push_constant) uniform Push { uint pixels; } push;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.pixels) return;
  float factor = exp(FETCH(gauge, 0).w);
  vec4 was = FETCH(before, int(i));
  STORE(intrinsic, i, vec4(was.rgb * factor, was.a / factor));
}
