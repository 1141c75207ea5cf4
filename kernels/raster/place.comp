// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Corners of a mesh under orthographic projection: position in pixels of the image (y down, z towards the camera) and
// normal in camera axes, alternating.
PLANE_IN(0, corners);
PLANE_OUT(1, placed);
layout(push_constant) uniform Push {
  vec4 x, y, z;  // rows of the turn; w = where the origin goes, in pixels
  float scale;   // pixels a unit
  uint count;
} push;

void main() {
  uint i = line_index();
  if (i >= push.count) return;
  vec3 p = FETCH(corners, int(2u * i)).xyz, n = FETCH(corners, int(2u * i + 1u)).xyz;
  vec3 at = vec3(dot(push.x.xyz, p), dot(push.y.xyz, p), dot(push.z.xyz, p)) * push.scale;
  STORE(placed, 2u * i, vec4(push.x.w + at.x, push.y.w - at.y, push.z.w + at.z, 0.0));
  STORE(placed, 2u * i + 1u, vec4(dot(push.x.xyz, n), dot(push.y.xyz, n), dot(push.z.xyz, n), 0.0));
}
