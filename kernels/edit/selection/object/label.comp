// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Labels for connected components (components.glsl): cells that belong to the object more than not.
SCALAR_IN(0, alpha);
PLANE_OUT(1, labels);
layout(push_constant) uniform Push { uvec2 cells; } push;

void main() {
  if (gl_GlobalInvocationID.x >= push.cells.x) return;
  uint n = gl_GlobalInvocationID.y * push.cells.x + gl_GlobalInvocationID.x;
  STORE(labels, n, vec4(0.0, 0.0, 0.0, FETCH1(alpha, int(n)) > 0.5 ? 0.0 : -1.0));
}
