// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/finite.glsl"

// ln R of every stride-th pixel of every stride-th row, for the palette: sampled, not averaged, so that no mixed colors of borders
// arise.
PLANE_IN(0, model);
PLANE_OUT(1, picked);
layout(push_constant) uniform Push {
  uvec2 size;         // of `picked`
  uint stride;        // pixels
  uint model_width;   // pixels
} push;

void main() {
  uvec2 at = gl_GlobalInvocationID.xy;
  if (at.x >= push.size.x) return;
  vec3 r = finite(FETCH(model, int(at.y * push.stride * push.model_width + at.x * push.stride))).rgb;
  STORE(picked, at.y * push.size.x + at.x, vec4(log(max(r, vec3(kReflectanceFloor))), 0.0));
}
