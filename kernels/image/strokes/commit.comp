// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"
#include "poses.glsl"

// Puts a mask in the place of the last one, and flags the tiles of 16 x 16 pixels where they differ. One pack of pixels an invocation.
PLANE_IN(0, next);
WORD_IN(1, moved);
PLANE_INOUT(2, mask);
WORD_OUT(3, changed);
layout(push_constant) uniform Push { uvec2 size; } push;

void main() {
  uint packs = PACK4(push.size.x);
  uvec2 position = grid_position(packs);
  // Devices that cannot skip a kernel run it also if nothing moved.
  if (position.y >= push.size.y || FETCH1(moved, MOVED_STROKES) == 0u) return;
  uint at = position.y * packs + position.x;
  vec4 now = FETCH(next, int(at));
  if (all(equal(LOAD(mask, at), now))) return;
  STORE(mask, at, now);
  STORE(changed, position.y / 16u * ((packs + 3u) / 4u) + position.x / 4u, 1u);
}
