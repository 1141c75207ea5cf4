// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "value.glsl"

// The sum of two images, or of an image and a vector: one block of one pixel per invocation.
layout(constant_id = 2) const bool kVector = false;  // the second is a vector

PLANE_IN(0, first);
PLANE_IN(1, second);
PLANE_OUT(2, result);
layout(push_constant) uniform Push {
  int area;      // pixels
  int elements;  // pixels of all blocks
} push;

void main() {
  int item = int(line_index());
  if (item >= push.elements) return;
  STORE(result, 1 + item, FETCH(first, 1 + item) + FETCH(second, 1 + (kVector ? item / push.area : item)));
}
