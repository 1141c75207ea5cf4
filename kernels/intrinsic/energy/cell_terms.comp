// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"
#include "intrinsic/guide/guide.glsl"
#include "intrinsic/temporal/temporal.glsl"

// The cells' part of the system (energy.glsl), from the prior; and, with kAnchored, how far their pixels may believe the
// frame before, and where the solve starts. With kLook also sums up how far that is. One pack of cells, a row of a tile, an
// invocation.
layout(constant_id = 1) const bool kAnchored = false;
layout(constant_id = 2) const bool kLook = false;
PLANE_IN(0, value);
PLANE_IN(1, cells);
PLANE_IN(2, mismatch);
PLANE_IN(3, tiles);
PLANE_IN(4, verdict);
PLANE_IN(5, before);    // cell_state (temporal.glsl)
PLANE_IN(6, means);     // the last frame's solution: means of the cells ...
PLANE_IN(7, correction);  // ... and what its last cycle added
PLANE_OUT(8, terms);
PLANE_OUT(9, start);
PLANE_INOUT(10, force);  // the last frame's, a good guess where this one continues it
PLANE_OUT(11, sums);     // of gate^2, -, -, -
PLANE_IN(12, activity);  // of tiles (activity.glsl)
#define TILE_CONSTANT 3
#define TILE_BINDING 13
#include "image/tiles/tile_position.glsl"
layout(push_constant) uniform Push {
  uvec2 size;    // of level 2
  float anchor;  // t where nothing moves
  float frames;  // how many frames it takes until it is that
  float motion;  // 1 / (share of structure around that moved which halves it)
  float hold;    // share of the last frame's reflectance that stays where neither content nor light changes
  float light;   // 1 / (change of light that halves that)
} push;

// How much structure, beside that of the tiles around, the frame's mean counts for.
const float kFrameStructure = 5.0;

// How much of the structure of 5 x 5 tiles has moved: one where content moves, little where light does.
float moved(ivec2 tile, ivec2 tiles_size, float frame) {
  vec2 sum = kFrameStructure * vec2(frame, 1.0);
  for (int y = max(tile.y - 2, 0); y <= min(tile.y + 2, tiles_size.y - 1); ++y)
    for (int x = max(tile.x - 2, 0); x <= min(tile.x + 2, tiles_size.x - 1); ++x)
      sum += FETCH(tiles, y * tiles_size.x + x).yz;
  return sum.x / sum.y;
}

// The gates of a pack of cells.
vec4 make(uint packs, uvec2 position) {
  int at = int(position.y * packs + position.x), tile = int((position.y / 4u) * packs + position.x);
  bvec4 inside = INSIDE(position.x, push.size.x);
  vec4 v = FETCH(value, VALUE_STRIDE * at + VALUE_WEIGHT), g = FETCH(value, VALUE_STRIDE * at + VALUE_CHROMA);
  vec4 target = FETCH(value, VALUE_STRIDE * at + VALUE_TARGET), mean = vec4(0.0), most = mean, gate = mean, change = mean, alike = mean;
  vec4 verdict_now = kAnchored ? FETCH(verdict, 0) : vec4(0.0);
  float quiet = 0.0;
  if (kAnchored) {
    float still = max(0.0, 1.0 - 2.0 * FETCH(tiles, tile).x);
    float motion = push.motion * moved(ivec2(position.x, position.y / 4u), ivec2(packs, (push.size.y + 3u) / 4u), verdict_now.z);
    motion *= motion;
    quiet = verdict_now.y * still * still / (1.0 + motion * motion);
  }
  for (uint k = 0u; k < 4u; ++k) {
    int cell = int(position.y * push.size.x + min(4u * position.x + k, push.size.x - 1u));
    vec4 guide = FETCH(cells, CELL_STRIDE * cell);
    mean = vec4(mean.yzw, guide.x);
    most = vec4(most.yzw, guide.x + guide.w);
    if (kAnchored) {
      alike = vec4(alike.yzw, 1.0 / (1.0 + FETCH(mismatch, cell).x));
      change = vec4(change.yzw, push.light * (guide.x - FETCH(before, cell).w));
    }
  }
  gate = quiet * alike;
  STORE(terms, TERMS_STRIDE * at + TERMS_SCREEN, v + g);
  STORE(terms, TERMS_STRIDE * at + TERMS_PULL, v * target);
  STORE(terms, TERMS_STRIDE * at + TERMS_CHROMA, g);
  STORE(terms, TERMS_STRIDE * at + TERMS_MEAN, MASKED(mean, inside));
  // Also where content around has moved, shading is nearer to what it was there than to the prior's guess.
  vec4 from = kAnchored ? mix(target, FETCH(means, at) + FETCH(correction, at), verdict_now.y * alike) : target;
  STORE(start, START_STRIDE * at + START_VALUE, from - most);
  STORE(start, START_STRIDE * at + START_GATE, gate);
  vec4 hold = gate * push.hold / (1.0 + change * change), share = vec4(1.0);
  if (kAnchored && kTileAcross > 0u) {
    // Where the frame stands for n, reflectance goes as far as it would have in n: hold^n of it stays, and against the weaker
    // anchor the slow parts of the solution, of which a frame lets through (1 - hold) of next to nothing, get n times that.
    float n = FETCH(activity, tile).y;
    if (n > 1.0) {
      vec4 held = pow(hold, vec4(n));
      share = (1.0 - held) / (n * (1.0 - hold));
      hold = held;
    }
  }
  STORE(start, START_STRIDE * at + START_HOLD, hold);
  vec4 pull_before = kAnchored ? gate * LOAD(force, FORCE_STRIDE * at + FORCE_PULL) : vec4(0.0);
  STORE(force, FORCE_STRIDE * at + FORCE_PULL, MASKED(pull_before, inside));
  STORE(force, FORCE_STRIDE * at + FORCE_SCREEN, v + g);
  float weight = push.anchor * min(verdict_now.w / push.frames, 1.0);
  STORE(force, FORCE_STRIDE * at + FORCE_ANCHOR, weight * MASKED(share * gate, inside));
  return MASKED(gate, inside);
}

void main() {
  uint packs = QUADS(push.size.x);
  uvec2 position = tile_position(packs);
  vec4 gate = vec4(0.0);
  if (position.y < push.size.y) gate = make(packs, position);
  if (kLook) SUM_PARTIALS(sums, vec4(dot(gate, gate), 0.0, 0.0, 0.0));
}
