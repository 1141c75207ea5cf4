// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"
#include "strokes.glsl"
#include "camera/same_surface.glsl"

// Adds strokes of a remembered scene to the mask, where no other is drawn. One pack of pixels an invocation.
WORD_IN(0, ids);
SCALAR_IN(1, known_depth);
SCALAR_IN(2, depth);
PLANE_IN(3, valid);
WORD_IN(4, numbers);  // of a stroke in the mask, by id; 0: it is not in this mask
PLANE_INOUT(5, mask);
layout(push_constant) uniform Push {
  uvec2 size;  // of the picture
  uvec2 seen;  // pixels of the images of the scene, which show the same
} push;

// Number and half of the weight at a place of those images, in their pixels. The weight is the square of 2 s - 1, limited to 0…1, s
// the share of the surroundings that has the same stroke: a tent 4 pixels across.
float stroke_at(vec2 place) {
  ivec2 last = ivec2(push.seen) - 1, nearest = clamp(ivec2(floor(place + 0.5)), ivec2(0), last);
  int at = nearest.y * int(push.seen.x) + nearest.x;
  uint id = FETCH1(ids, at), number = FETCH1(numbers, int(id));
  float here = FETCH1(depth, at), there = FETCH1(known_depth, at);
  // Where the frame has no depth, nothing says that something else is in front.
  bool same = here == 0.0 || same_surface(here, there);
  if (number == 0u || !same) return 0.0;
  ivec2 first = ivec2(floor(place)) - 1;
  float sum = 0.0, total = 0.0;
  for (int n = 0; n < 16; ++n) {
    ivec2 p = first + ivec2(n & 3, n >> 2), inside = clamp(p, ivec2(0), last);
    vec2 near = max(1.0 - 0.5 * abs(vec2(p) - place), 0.0);
    float weight = p == inside ? near.x * near.y : 0.0;
    sum += FETCH1(ids, inside.y * int(push.seen.x) + inside.x) == id ? weight : 0.0;
    total += weight;
  }
  float deep = clamp(2.0 * sum / total - 1.0, 0.0, 1.0);
  return deep > 0.0 ? float(number) + 0.5 * deep * deep : 0.0;
}

void main() {
  uint packs = PACK4(push.size.x);
  uvec2 position = grid_position(packs);
  if (position.y >= push.size.y || !(FETCH(valid, 0).x > 0.0)) return;
  uint to = position.y * packs + position.x;
  vec4 pack = LOAD(mask, to), drawn = pack;
  vec2 scale = vec2(push.seen) / vec2(push.size);
  for (uint k = 0u; k < 4u; ++k) {
    uint x = 4u * position.x + k;
    if (x < push.size.x && pack[k] == 0.0) pack[k] = stroke_at((vec2(x, position.y) + 0.5) * scale - 0.5);
  }
  if (pack != drawn) STORE(mask, to, pack);
}
