// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/finite.glsl"
#include "stylize.glsl"

// The mean of E(S) over cells of factor x factor pixels. The border goes on beyond the frame.
PLANE_IN(0, intrinsic);
SCALAR_OUT(1, cells);
layout(push_constant) uniform Push {
  uvec2 size;   // in cells
  uvec2 frame;  // in pixels
  uint factor;
  uint first_row;
} push;

void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y);
  if (at.x >= push.size.x || at.y >= push.size.y) return;
  float sum = 0.0;
  for (uint y = 0u; y < push.factor; ++y) {
    uint row = min(at.y * push.factor + y, push.frame.y - 1u) * push.frame.x;
    for (uint x = 0u; x < push.factor; ++x) {
      uint column = min(at.x * push.factor + x, push.frame.x - 1u);
      sum += encoded(finite(FETCH(intrinsic, int(row + column))).w);
    }
  }
  STORE(cells, BY_ROWS(at.y * push.size.x + at.x), sum / float(push.factor * push.factor));
}
