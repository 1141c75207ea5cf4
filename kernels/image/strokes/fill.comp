// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"
#define ROOTS_SLOT 1
#include "image/components/components.glsl"

// Adds to the mask what is filled. One pack of pixels an invocation.
PLANE_IN(0, labels);
WORD_IN(2, claims);
PLANE_INOUT(3, mask);
layout(push_constant) uniform Push { uvec2 size; } push;

void main() {
  uint packs = PACK4(push.size.x);
  uvec2 position = grid_position(packs);
  if (position.y >= push.size.y) return;
  uint to = position.y * packs + position.x;
  vec4 pack = LOAD(mask, to);
  for (uint k = 0u; k < 4u; ++k) {
    uint x = 4u * position.x + k, n = position.y * push.size.x + x;
    if (x >= push.size.x || pack[k] > 0.0) continue;
    vec4 label = FETCH(labels, int(n));
    if (label.w >= 0.0 && label.x > 0.0 && FETCH1(claims, int(root_of(n))) > 0u) pack[k] = label.w + 1.0 + 0.5 * label.x;
  }
  STORE(mask, to, pack);
}
