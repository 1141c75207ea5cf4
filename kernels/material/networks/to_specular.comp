// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "material/layers/lime.glsl"

// Input of SpecularNet: the image on the object, and the mask.
PLANE_IN(0, image);
PLANE_IN(1, probability);
PLANE_OUT(2, result);
layout(push_constant) uniform Push { int count; } push;

void main() {
  int i = int(line_index());
  if (i >= push.count) return;
  float mask = FETCH(probability, 1 + i).x > kObject ? 1.0 : 0.0;
  STORE(result, 1 + i, vec4(mask * FETCH(image, 1 + i).rgb, mask));
}
