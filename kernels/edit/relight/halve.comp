// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// The next coarser level of a pyramid: weights 1 3 3 1 along both axes. The border goes on beyond the grid.
SCALAR_IN(0, fine);
SCALAR_OUT(1, coarse);
layout(push_constant) uniform Push {
  uvec2 size;  // of the coarse level
  uvec2 fine_size;
} push;

const float kWeight[4] = float[4](0.125, 0.375, 0.375, 0.125);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy), last = ivec2(push.fine_size) - 1;
  if (at.x >= int(push.size.x) || at.y >= int(push.size.y)) return;
  float sum = 0.0;
  for (int j = 0; j < 4; ++j) {
    int row = clamp(2 * at.y + j - 1, 0, last.y) * int(push.fine_size.x);
    for (int i = 0; i < 4; ++i)
      sum += kWeight[i] * kWeight[j] * FETCH1(fine, row + clamp(2 * at.x + i - 1, 0, last.x));
  }
  STORE(coarse, at.y * int(push.size.x) + at.x, sum);
}
