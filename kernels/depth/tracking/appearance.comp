// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Ln brightness of a view under the light of the frame seen from the same pose: ln of the mean channel of the view's reflectance plus
// ln S; of that frame itself where the view has no reflectance; ln of the reflectance where the frame is black. One pixel an invocation.
PLANE_IN(0, reflectance);  // rgb: ln R of the view; w: confidence
PLANE_IN(1, layers);       // of the frame: w = S
SCALAR_IN(2, brightness);  // of the frame, ln
SCALAR_OUT(3, appearance);
layout(push_constant) uniform Push { uint pixels; } push;

const float kBlack = 1e-3;  // S up to which a frame counts as black

void main() {
  uint at = line_index();
  if (at >= push.pixels) return;
  vec4 r = FETCH(reflectance, int(at));
  float shading = FETCH(layers, int(at)).w;
  float lit = log(max(dot(exp(r.rgb), vec3(1.0 / 3.0)) * (shading > kBlack ? shading : 1.0), 1e-3));
  STORE(appearance, at, r.w > 0.0 ? lit : FETCH1(brightness, int(at)));
}
