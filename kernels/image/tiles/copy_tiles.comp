// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"

// Copies the listed tiles of a plane with kStride vec4 per four pixels. One such group per invocation.
layout(constant_id = 1) const uint kStride = 1u;
PLANE_IN(0, from);
PLANE_OUT(1, to);
#define TILE_CONSTANT 2
#define TILE_BINDING 2
#include "tile_position.glsl"
layout(push_constant) uniform Push { uvec2 packs; } push;  // a row, rows

void main() {
  uvec2 position = tile_position(push.packs.x);
  if (position.y >= push.packs.y) return;
  uint at = kStride * (position.y * push.packs.x + position.x);
  for (uint k = 0u; k < kStride; ++k) STORE(to, at + k, FETCH(from, int(at + k)));
}
