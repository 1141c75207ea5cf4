// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gpu/common.glsl"

// First and last column and row around point i of side x side ones: two in each direction, clamped to the grid.
ivec4 around(int i, int side) {
  ivec2 at = ivec2(i % side, i / side);
  return ivec4(max(at - 2, 0), min(at + 2, side - 1));
}

// Last component of the regression of a point that does not count.
const float kNone = -1e30;

// Noise variance of light at white, and of its square root at any light: much smaller variances are noise, not edges.
const float kNoise = 1e-3;
