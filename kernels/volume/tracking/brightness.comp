// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Ln of the mean channel of a linear picture. One pixel an invocation.
PLANE_IN(0, picture);
SCALAR_OUT(1, brightness);
layout(push_constant) uniform Push { uint pixels; } push;

void main() {
  uint at = line_index();
  if (at < push.pixels) STORE(brightness, at, log(max(dot(FETCH(picture, int(at)).rgb, vec3(1.0 / 3.0)), 1e-3)));
}
