// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "lime.glsl"
#include "image/srgb.glsl"

// Inputs of the guided filter at each point: the image's smallest channel, to which a white highlight adds as to any,
// and the specular layer, bounded by it; linear. Zero beside the object.
PLANE_IN(0, masked);
PLANE_IN(1, codes);
PLANE_OUT(2, result);  // guide, layer, 0, mask
layout(push_constant) uniform Push { int count; } push;

void main() {
  int i = int(line_index());
  if (i >= push.count) return;
  vec4 here = FETCH(masked, 1 + i);
  float guide = to_linear(vec3(min(here.r, min(here.g, here.b)))).x;
  float layer = min(decode(FETCH(codes, 1 + i).x), guide);
  STORE(result, i, here.w * vec4(guide, layer, 0.0, 1.0));
}
