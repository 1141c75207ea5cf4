// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "lime.glsl"
#include "image/finite.glsl"
#include "image/srgb.glsl"

// Inputs of the guided filter for the mask at each point: the image's color, transformed by `guide_of`, and the
// probability of the object.
PLANE_IN(0, image);  // sRGB; behind one zero, as networks have it
PLANE_IN(1, probability);
PLANE_OUT(2, result);
layout(push_constant) uniform Push { int count; } push;

void main() {
  int i = int(line_index());
  if (i < push.count)
    STORE(result, i, vec4(guide_of(to_linear(FETCH(image, 1 + i).rgb)), finite(FETCH(probability, 1 + i)).x));
}
