// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"
#include "intrinsic/guide/guide.glsl"
#include "intrinsic/temporal/temporal.glsl"

// The cells' part of the system (energy.glsl), from the prior; with kAnchored also the gate of the temporal anchor and the initial
// solution. With kMeasure also sums the squared gates. One pack of cells, a row of a tile, an invocation.
layout(constant_id = 1) const bool kAnchored = false;
layout(constant_id = 2) const bool kMeasure = false;
PLANE_IN(0, value);
PLANE_IN(1, cells);
PLANE_IN(2, mismatch);
PLANE_IN(3, tiles);
PLANE_IN(4, cut_decision);
PLANE_IN(5, before);    // cell_state (temporal.glsl)
PLANE_IN(6, means);     // the last frame's solution: means of the cells ...
PLANE_IN(7, correction);  // ... and the correction of its last cycle
PLANE_OUT(8, terms);
PLANE_OUT(9, start);
PLANE_INOUT(10, source_term);  // of the last frame: a good initial value if this frame continues it
PLANE_OUT(11, sums);
#define GATE_SQUARES 0   // sum of gate^2
layout(push_constant) uniform Push {
  uvec2 size;    // of level 2
  float anchor;  // t without motion
  float frames;  // until t reaches that
  float motion;  // 1 / (share of structure around that moved which halves it)
  float hold;    // share of the last frame's reflectance to keep if neither content nor light changes
  float light;   // 1 / (change of light that halves that)
} push;

// Weight of the frame's mean structure against that of the tiles around.
const float kFrameStructure = 5.0;

// Share of the structure of 5 x 5 tiles that has moved: 1 for moving content, little for a change of light.
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
  vec4 target = FETCH(value, VALUE_STRIDE * at + VALUE_TARGET), mean = vec4(0.0), max_channel = mean, gate = mean, change = mean, cell_gate = mean;
  vec4 decision = kAnchored ? FETCH(cut_decision, 0) : vec4(0.0);
  float tile_gate = 0.0;
  if (kAnchored) {
    float tile_match = max(0.0, 1.0 - 2.0 * FETCH(tiles, tile).x);
    float motion = push.motion * moved(ivec2(position.x, position.y / 4u), ivec2(packs, (push.size.y + 3u) / 4u), decision[CUT_MOVED]);
    motion *= motion;
    tile_gate = decision[CUT_ANCHORED] * tile_match * tile_match / (1.0 + motion * motion);
  }
  for (uint k = 0u; k < 4u; ++k) {
    int cell = int(position.y * push.size.x + min(4u * position.x + k, push.size.x - 1u));
    vec4 guide = FETCH(cells, CELL_STRIDE * cell);
    mean = vec4(mean.yzw, guide.x);
    max_channel = vec4(max_channel.yzw, guide.x + guide.w);
    if (kAnchored) {
      cell_gate = vec4(cell_gate.yzw, 1.0 / (1.0 + FETCH(mismatch, cell).x));
      change = vec4(change.yzw, push.light * (guide.x - FETCH(before, cell).w));
    }
  }
  gate = tile_gate * cell_gate;
  STORE(terms, TERMS_STRIDE * at + TERMS_SCREENING, v + g);
  STORE(terms, TERMS_STRIDE * at + TERMS_DATA, v * target);
  STORE(terms, TERMS_STRIDE * at + TERMS_CHROMA, g);
  STORE(terms, TERMS_STRIDE * at + TERMS_MEAN, MASKED(mean, inside));
    // Shading at a place with motion around is nearer to its earlier value than to the prior's.
  vec4 from = kAnchored ? mix(target, FETCH(means, at) + FETCH(correction, at), decision[CUT_ANCHORED] * cell_gate) : target;
  STORE(start, START_STRIDE * at + START_VALUE, from - max_channel);
  STORE(start, START_STRIDE * at + START_GATE, gate);
  STORE(start, START_STRIDE * at + START_HOLD, gate * push.hold / (1.0 + change * change));
  vec4 source_before = kAnchored ? gate * LOAD(source_term, SOURCE_STRIDE * at + SOURCE_VALUE) : vec4(0.0);
  STORE(source_term, SOURCE_STRIDE * at + SOURCE_VALUE, MASKED(source_before, inside));
  STORE(source_term, SOURCE_STRIDE * at + SOURCE_SCREENING, v + g);
  float weight = push.anchor * min(decision[CUT_FRAMES] / push.frames, 1.0);
  STORE(source_term, SOURCE_STRIDE * at + SOURCE_ANCHOR, weight * MASKED(gate, inside));
  return MASKED(gate, inside);
}

void main() {
  uint packs = PACK4(push.size.x);
  uvec2 position = grid_position(packs);
  vec4 gate = vec4(0.0);
  if (position.y < push.size.y) gate = make(packs, position);
  vec4 sum = vec4(0.0);
  sum[GATE_SQUARES] = dot(gate, gate);
  if (kMeasure) SUM_PARTIALS(sums, sum);
}
