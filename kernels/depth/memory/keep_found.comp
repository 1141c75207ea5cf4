// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "depth/tracking/tracking.glsl"

// The depth of a frame whose pose is known; else nothing, so that nothing is added in a wrong place. One pixel an invocation.
SCALAR_IN(0, depth);
PLANE_IN(1, found);
SCALAR_OUT(2, kept);
layout(push_constant) uniform Push { uint pixels; } push;

void main() {
  uint at = line_index();
  if (at >= push.pixels) return;
  float z = FETCH1(depth, int(at));
  STORE(kept, at, FETCH(found, int(kFound)).x > 0.0 ? z : 0.0);
}
