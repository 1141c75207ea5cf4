// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "material/layers/lime.glsl"
#include "image/finite.glsl"

// Input of ExponentNet: codes of the specular layer and of the mirror image, on the object.
PLANE_IN(0, masked);
PLANE_IN(1, specular);
PLANE_IN(2, mirror);
PLANE_OUT(3, result);
layout(push_constant) uniform Push { int count; } push;

void main() {
  int i = int(line_index());
  if (i >= push.count) return;
  STORE(result, 1 + i, vec4(FETCH(specular, 1 + i).x, FETCH(masked, 1 + i).w * finite(FETCH(mirror, 1 + i)).x, 0.0, 0.0));
}
