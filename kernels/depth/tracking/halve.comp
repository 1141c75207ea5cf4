// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/jump.glsl"

// Halves a depth image, to the mean of those of four pixels that are near the nearest one, and ln brightness. One coarse pixel an
// invocation.
SCALAR_IN(0, fine_depth);
SCALAR_IN(1, fine_brightness);
SCALAR_OUT(2, depth);
SCALAR_OUT(3, brightness);
layout(push_constant) uniform Push {
  uvec2 size;  // of the fine ones
} push;


void main() {
  uvec2 half_size = (push.size + 1u) / 2u;
  uint line = line_index();
  uvec2 at = uvec2(line % half_size.x, line / half_size.x);
  if (at.y >= half_size.y) return;
  vec4 z, b;
  for (int n = 0; n < 4; ++n) {
    uvec2 from = min(2u * at + uvec2(n & 1, n >> 1), push.size - 1u);
    int index = int(from.y * push.size.x + from.x);
    z[n] = FETCH1(fine_depth, index);
    b[n] = FETCH1(fine_brightness, index);
  }
  vec4 known = mix(z, vec4(1e9), lessThanEqual(z, vec4(0.0)));
  float nearest = min(min(known.x, known.y), min(known.z, known.w));
  vec4 near = vec4(lessThan(known, vec4(nearest * (1.0 + kJump))));
  STORE(depth, line, nearest < 1e9 ? dot(near, z) / dot(near, vec4(1.0)) : 0.0);
  STORE(brightness, line, dot(b, vec4(0.25)));
}
