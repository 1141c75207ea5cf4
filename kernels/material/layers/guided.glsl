#include "gpu/common.glsl"

// First and last column and row around point i of side x side ones: two to each side, where there are so many.
ivec4 around(int i, int side) {
  ivec2 at = ivec2(i % side, i / side);
  return ivec4(max(at - 2, 0), min(at + 2, side - 1));
}

// Variance of light at white, and of its roots at any light: much less of it is noise and no edge.
const float kNoise = 1e-3;
