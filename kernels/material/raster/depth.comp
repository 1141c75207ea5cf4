// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "visible.glsl"

// Mean depth of a mesh where it covers a pixel, and coverage.
PLANE_OUT(3, picture);

void main() {
  uvec2 at = pixel_of(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, push.size))) return;
  Seen seen[2];
  find_visible(at, seen);
  vec4 there[2] = vec4[2](vec4(greaterThan(seen[0].who, ivec4(kNone))), vec4(greaterThan(seen[1].who, ivec4(kNone))));
  float count = dot(there[0] + there[1], vec4(1.0));
  float depth = dot(there[0], seen[0].depth) + dot(there[1], seen[1].depth);
  STORE(picture, push.first + at.y * push.stride + at.x, vec4(depth / max(count, 1.0), count / 8.0, 0.0, 0.0));
}
