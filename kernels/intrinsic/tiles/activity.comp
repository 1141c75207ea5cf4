// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/temporal/temporal.glsl"
#include "image/pack4.glsl"

// The change of log shading of every tile per frame, from the brightness of reflectance, which mirrors it if the input is
// unchanged. Counts the tiles that the next frame will not skip. One tile an invocation.
WORD_IN(0, changed);
PLANE_IN(1, before);  // memory of the last frame
PLANE_IN(2, now);
PLANE_INOUT(3, activity);
WORD_INOUT(4, moving);  // one word
#define TILE_CONSTANT 1
#define TILE_BINDING 5
#include "image/tiles/tile_position.glsl"
layout(push_constant) uniform Push {
  uvec2 tiles;
  uvec2 packs;  // a row, rows
  uvec2 size;
  float tolerance;
} push;
#include "activity.glsl"

void main() {
  uvec2 tile = tile_position(push.tiles.x);
  if (tile.y >= push.tiles.y) return;
  uvec2 first = uvec2(4u, 16u) * tile, last = min(first + uvec2(4u, 16u), push.packs);
  vec4 sum = vec4(0.0);
  for (uint y = first.y; y < last.y; ++y)
    for (uint x = first.x; x < last.x; ++x) {
      int at = int(MEMORY_STRIDE * (y * push.packs.x + x)) + MEMORY_BRIGHTNESS;
      vec4 step = FETCH(now, at) - FETCH(before, at);
      sum += MASKED(step * step, INSIDE(x, push.size.x));
    }
  uvec2 pixels = min(push.size - 16u * tile, uvec2(16u));
  uint at = tile.y * push.tiles.x + tile.x;
  float frames = kTileAcross == 0u ? 1.0 : LOAD(activity, at).y;
  float moved = near_change(ivec2(tile), ivec2(push.tiles)) ? kMoving : sqrt(dot(sum, vec4(1.0)) / float(pixels.x * pixels.y)) / frames;
  STORE(activity, at, vec4(moved, 0.0, frames, 0.0));
  if (!(moved <= push.tolerance)) atomicAdd(LOAD(moving, 0), 1u);
}
