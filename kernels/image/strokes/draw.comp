// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"
#include "strokes.glsl"

// Draws strokes, placed by place.comp, without what they fill. Where they overlap, the later one covers the earlier one unless its
// weight is smaller. One pack of pixels an invocation.
PLANE_IN(0, strokes);
SCALAR_IN(1, depths);  // of all patches, 1 and more where the weight is 1
PLANE_OUT(2, mask);
layout(push_constant) uniform Push {
  uvec2 size;
  uint count;
} push;

float texel(ivec2 at, ivec2 size, int first) {
  return all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, size)) ? FETCH1(depths, first + at.y * size.x + at.x) : -1.0;
}

float weight_at(vec2 pixel, vec4 map, vec4 patch_at) {
  vec2 p = vec2(map.x * pixel.x - map.y * pixel.y, map.x * pixel.y + map.y * pixel.x) + map.zw - 0.5;
  ivec2 at = ivec2(floor(p)), size = ivec2(patch_at.xy);
  vec2 part = p - vec2(at);
  int first = 16 * int(patch_at.z);
  float top = mix(texel(at, size, first), texel(at + ivec2(1, 0), size, first), part.x);
  float bottom = mix(texel(at + ivec2(0, 1), size, first), texel(at + ivec2(1, 1), size, first), part.x);
  float depth = clamp(mix(top, bottom, part.y), 0.0, 1.0);
  return depth * depth;
}

void main() {
  uint packs = PACK4(push.size.x);
  uvec2 position = grid_position(packs);
  if (position.y >= push.size.y) return;
  vec4 number = vec4(0.0), best = vec4(0.0);
  vec2 cell = vec2(position.x, position.y / 4u);
  for (uint i = 0u; i < push.count; ++i) {
    int from = STROKE_STRIDE * int(i);
    vec4 box = FETCH(strokes, from + STROKE_BOX);
    if (any(lessThan(cell, box.xy)) || any(greaterThanEqual(cell, box.zw))) continue;
    vec4 map = FETCH(strokes, from + STROKE_MAP), patch_at = FETCH(strokes, from + STROKE_PATCH);
    for (uint k = 0u; k < 4u; ++k) {
      float weight = weight_at(vec2(4u * position.x + k, position.y) + 0.5, map, patch_at);
      if (!(weight > 0.0) || weight < best[k]) continue;
      best[k] = weight;
      number[k] = float(i + 1u);
    }
  }
  STORE(mask, position.y * packs + position.x, MASKED(number + 0.5 * best, INSIDE(position.x, push.size.x)));
}
