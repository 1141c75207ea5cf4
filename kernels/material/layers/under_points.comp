// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "lime.glsl"
#include "image/srgb.glsl"

// The object's light without highlights at valid points of the square; w: validity.
PLANE_IN(0, masked);  // sRGB where the object is, and its mask; behind one zero, as networks have it
PLANE_IN(1, codes);   // of the specular layer in x
PLANE_OUT(2, result);
layout(push_constant) uniform Push { int count; } push;

void main() {
  int i = int(line_index());
  if (i >= push.count) return;
  vec4 here = FETCH(masked, 1 + i);
  vec3 rgb = to_linear(here.rgb);
  float specular = decode(FETCH(codes, 1 + i).x);
  // Values near full scale may be clipped, and points whose specular layer exceeds the value are unreliable.
  bool known = here.w > 0.5 && max(rgb.r, max(rgb.g, rgb.b)) < kClips.x && specular < min(rgb.r, min(rgb.g, rgb.b));
  STORE(result, i, known ? vec4(rgb - specular, 1.0) : vec4(0.0));
}
