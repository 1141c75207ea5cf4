// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "levels.glsl"

// A level of the pyramid from the one before, or the first one from the frame. One value an invocation.
layout(constant_id = 1) const bool kFrame = false;
PLANE_IN(0, frame);
SCALAR_INOUT(1, pyramid);
layout(push_constant) uniform Push {
  uvec2 fine_size, size;
  uint fine, coarse;  // their first values
} push;

float value_at(uint x, uint y) {
  uvec2 at = min(uvec2(x, y), push.fine_size - 1u);
  uint n = at.y * push.fine_size.x + at.x;
  return kFrame ? log_light(FETCH(frame, int(n))) : LOAD(pyramid, push.fine + n);
}

void main() {
  uvec2 at = gl_GlobalInvocationID.xy;
  if (at.x >= push.size.x) return;
  uvec2 p = 2u * at;
  STORE(pyramid, push.coarse + at.y * push.size.x + at.x,
        0.25 * (value_at(p.x, p.y) + value_at(p.x + 1u, p.y) + value_at(p.x, p.y + 1u) + value_at(p.x + 1u, p.y + 1u)));
}
