// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Corners of a mesh in an image: position in pixels (y down) and depth, and normal in camera axes, alternating. Under orthographic
// projection depth is in pixels towards the camera. Behind a lens it is 1 / distance along the optical axis, which is linear in the
// image as well, and normals are divided by the distance, so that interpolating them is right in perspective.
PLANE_IN(0, corners);
PLANE_OUT(1, placed);  // w of positions: -1 behind the camera, else 0
layout(push_constant) uniform Push {
  vec4 x, y, z;  // rows of the turn; w = where the origin goes: pixels, behind a lens the same unit as scale
  vec4 lens;     // focal lengths and center, pixels; 0: orthographic
  float scale;   // pixels a unit, behind a lens any length
  uint count;
} push;

const float kNearest = 0.02;  // distance below which corners count as behind the camera

void main() {
  uint i = line_index();
  if (i >= push.count) return;
  vec3 p = FETCH(corners, int(2u * i)).xyz, n = FETCH(corners, int(2u * i + 1u)).xyz;
  vec3 at = vec3(dot(push.x.xyz, p), dot(push.y.xyz, p), dot(push.z.xyz, p)) * push.scale;
  vec3 normal = vec3(dot(push.x.xyz, n), dot(push.y.xyz, n), dot(push.z.xyz, n));
  vec4 seen = vec4(push.x.w + at.x, push.y.w - at.y, push.z.w + at.z, 0.0);
  if (push.lens.x > 0.0) {
    at += vec3(push.x.w, push.y.w, push.z.w);
    float inverse = 1.0 / max(-at.z, kNearest);
    seen = vec4(push.lens.zw + push.lens.xy * vec2(at.x, -at.y) * inverse, inverse, -at.z > kNearest ? 0.0 : -1.0);
    normal *= inverse;
  }
  STORE(placed, 2u * i, seen);
  STORE(placed, 2u * i + 1u, vec4(normal, 0.0));
}
