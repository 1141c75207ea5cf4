// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "edit.glsl"

// Sums the diffuse and the specular layer of a frame, and adds the change of either edit. Unedited layers sum to the frame, but for
// rounding.
layout(constant_id = 1) const bool DIFFERENCE = false;  // (sum − frame) / 2 on middle gray instead

PLANE_IN(0, frame);     // linear RGB, alpha
PLANE_IN(1, diffuse);   // w: mask
PLANE_IN(2, specular);  // w: mirror image
PLANE_OUT(3, picture);
layout(push_constant) uniform Push {
  uvec2 size;
  float strength;  // 0: the frame, 1: the layers
  uint first_row;
} push;


void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y * kRows);
  if (at.x >= push.size.x) return;
  uint last = min(at.y + kRows, push.size.y);
  for (uint y = at.y; y < last; ++y) {
    int n = int(y * push.size.x + at.x);
    vec4 seen = finite(FETCH(frame, n));
    vec3 change = finite(FETCH(diffuse, n)).rgb + finite(FETCH(specular, n)).rgb - seen.rgb;
    vec3 drawn = DIFFERENCE ? kMiddleGray + 0.5 * change : seen.rgb + push.strength * change;
    STORE(picture, BY_ROWS(n), vec4(clamp(drawn, vec3(0.0), vec3(kLargest)), min(seen.w, 1.0)));
  }
}
