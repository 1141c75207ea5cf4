// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Takes single pixels of a view without a stroke into the one that at least five of their eight neighbors have: voxels whose
// reflectance is too noisy to be filled leave such holes. One pixel an invocation.
WORD_IN(0, ids);
WORD_OUT(1, closed);
layout(push_constant) uniform Push { uvec2 size; } push;

const uint kNeighbors = 5u;

void main() {
  uint line = line_index();
  ivec2 pixel = ivec2(line % push.size.x, line / push.size.x), last = ivec2(push.size) - 1;
  if (pixel.y > last.y) return;
  uint id = FETCH1(ids, int(line)), near[8];
  for (int n = 0; n < 8; ++n) {
    int k = n < 4 ? n : n + 1;
    ivec2 p = pixel + ivec2(k % 3, k / 3) - 1, inside = clamp(p, ivec2(0), last);
    near[n] = p == inside ? FETCH1(ids, inside.y * int(push.size.x) + inside.x) : 0u;
  }
  uint found = 0u;
  // One that five of eight have is among any four.
  for (int n = 0; n < 4; ++n) {
    uint count = 0u;
    for (int k = 0; k < 8; ++k) count += near[k] == near[n] ? 1u : 0u;
    found = count >= kNeighbors ? near[n] : found;
  }
  STORE(closed, line, id == 0u ? found : id);
}
