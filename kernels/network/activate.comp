// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "value.glsl"

// An activation that could not be fused into the node before.
PLANE_IN(0, image);
PLANE_OUT(1, result);
layout(push_constant) uniform Push {
  int elements;
  float slope;
} push;

void main() {
  int item = int(line_index());
  if (item < push.elements) STORE(result, 1 + item, activated(FETCH(image, 1 + item), push.slope));
}
