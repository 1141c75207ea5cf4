// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/finite.glsl"

// The frame with a sphere in front of it, shaded from the table of a lit sphere.
PLANE_IN(0, frame);
#define LIT_TABLE LIT_TABLE  // names are pasted, so that it has to be the binding's own
PLANE_IN(1, LIT_TABLE);
PLANE_OUT(2, picture);
layout(push_constant) uniform Push {
  uvec2 size;
  vec2 middle;   // of the sphere, pixels
  float radius;  // pixels
  uint side;     // of the table
  uint first_row;
} push;
const uint kRows = 4u;  // pixels an invocation, one above the other

#include "environment/lit_sphere.glsl"

void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y * kRows);
  if (at.x >= push.size.x) return;
  uint last = min(at.y + kRows, push.size.y);
  for (uint y = at.y; y < last; ++y) {
    int n = int(y * push.size.x + at.x);
    vec4 pixel = FETCH(frame, n);
    vec2 off = (vec2(at.x, y) + 0.5 - push.middle) / push.radius;
    float distance_ = length(off);
    // Coverage of the pixel, with a locally straight edge.
    float covered = clamp(0.5 + push.radius * (1.0 - distance_), 0.0, 1.0);
    vec3 normal = vec3(off.x, -off.y, sqrt(max(1.0 - distance_ * distance_, 0.0)));
    vec3 lit = finite(vec4(lit_sphere(normal, push.side), 1.0)).rgb;
    STORE(picture, BY_ROWS(n), vec4(mix(finite(pixel).rgb, lit, covered), pixel.w));
  }
}
