// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Half the size: the mean of the valid ones of 2 x 2 points; w: 1 if at least one is fully valid.
PLANE_IN(0, fine);
PLANE_OUT(1, coarse);
layout(push_constant) uniform Push { int side; } push;  // of fine

void main() {
  int half_ = (push.side + 1) / 2, i = int(line_index());
  if (i >= half_ * half_) return;
  ivec2 first = 2 * ivec2(i % half_, i / half_);
  vec4 sum = vec4(0.0);
  for (int y = first.y; y < min(first.y + 2, push.side); ++y)
    for (int x = first.x; x < min(first.x + 2, push.side); ++x) {
      vec4 point = FETCH(fine, y * push.side + x);
      sum += vec4(point.rgb * point.w, point.w);
    }
  STORE(coarse, i, vec4(sum.rgb / max(sum.w, 1e-6), min(sum.w, 1.0)));
}
