#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/quad.glsl"

// Copies the listed tiles of a plane with kStride vec4 per four pixels. One such group per invocation.
layout(constant_id = 1) const uint kStride = 1u;
PLANE_IN(0, from);
PLANE_OUT(1, to);
#define TILE_CONSTANT 2
#define TILE_BINDING 2
#include "tile_position.glsl"
layout(push_constant) uniform Push { uvec2 quads; } push;  // a row, rows

void main() {
  uvec2 position = tile_position(push.quads.x);
  if (position.y >= push.quads.y) return;
  uint at = kStride * (position.y * push.quads.x + position.x);
  for (uint k = 0u; k < kStride; ++k) STORE(to, at + k, FETCH(from, int(at + k)));
}
