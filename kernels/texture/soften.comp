// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "plane.glsl"

// Cells that are hidden, without single ones and with soft edges: the binomial mean over 5 x 5 cells, of which kNone and less
// become 0, kAll and more become 1.
SCALAR_IN(0, hidden);
SCALAR_OUT(1, softened);
layout(push_constant) uniform Push {
  uvec2 cells;
} push;

const float kNone = 0.2, kAll = 0.6;
const float kBinomial[5] = {1.0, 4.0, 6.0, 4.0, 1.0};

void main() {
  uint n = line_index();
  if (n >= push.cells.x * push.cells.y) return;
  ivec2 cell = ivec2(n % push.cells.x, n / push.cells.x), last = ivec2(push.cells) - 1;
  float sum = 0.0;
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) {
      ivec2 at = clamp(cell + ivec2(x, y), ivec2(0), last);
      sum += kBinomial[x + 2] * kBinomial[y + 2] * FETCH1(hidden, at.y * int(push.cells.x) + at.x);
    }
  STORE(softened, n, 1.0 - falling((sum / 256.0 - kNone) / (kAll - kNone)));
}
