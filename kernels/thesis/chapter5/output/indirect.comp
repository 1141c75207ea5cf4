// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"

// Four indirect layers as shares of S, T_k / S. slot: the plane of the field.
PLANE_IN(0, state);
PLANE_IN(1, intrinsic);
PLANE_OUT(2, indirect);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  float mean = FETCH(intrinsic, n).w;
  vec4 light = max(FETCH(state, push.slot * push.size.x * push.size.y + n), 0.0);
  STORE(indirect, n, mean > kDarkest ? light / mean : vec4(0.0));
}
