// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Back to full size: invalid points are interpolated bilinearly from the coarser level.
PLANE_IN(0, fine);
PLANE_IN(1, coarse);  // without gaps
PLANE_OUT(2, whole);
layout(push_constant) uniform Push { int side; } push;  // of fine

void main() {
  int half_ = (push.side + 1) / 2, i = int(line_index());
  if (i >= push.side * push.side) return;
  vec4 here = FETCH(fine, i);
  vec2 at = clamp(0.5 * (vec2(i % push.side, i / push.side) + 0.5) - 0.5, vec2(0.0), vec2(half_ - 1));
  ivec2 low = ivec2(at), high = min(low + 1, half_ - 1);
  vec2 share = at - vec2(low);
  vec3 around = mix(mix(FETCH(coarse, low.y * half_ + low.x).rgb, FETCH(coarse, low.y * half_ + high.x).rgb, share.x),
                    mix(FETCH(coarse, high.y * half_ + low.x).rgb, FETCH(coarse, high.y * half_ + high.x).rgb, share.x),
                    share.y);
  STORE(whole, i, vec4(mix(around, here.rgb, here.w), 1.0));
}
