#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"
#include "guide.glsl"
#include "temporal.glsl"

// The cells' part of the system (energy.glsl), from the prior and, with kAnchored, the frame before; and where the solve
// starts: at the prior's V, or where the frame before may be believed at its reflectance. One quad of cells an invocation.
layout(constant_id = 1) const bool kAnchored = false;
PLANE_IN(0, value);
PLANE_IN(1, cells);
PLANE_IN(2, wide);
PLANE_IN(3, before);
SCALAR_IN(4, tiles);
PLANE_IN(5, verdict);
PLANE_OUT(6, terms);
PLANE_OUT(7, start);
PLANE_INOUT(8, force);  // the last frame's, a good guess where this one continues it
layout(push_constant) uniform Push {
  uvec2 size;    // of level 2
  float anchor;  // t where nothing moves
  float detail;
  float chroma;
} push;

void main() {
  uint quads = QUADS(push.size.x);
  uvec2 position = grid_position(quads);
  if (position.y >= push.size.y) return;
  int at = int(position.y * quads + position.x), tile = int((position.y / 4u) * quads + position.x);
  bvec4 inside = INSIDE(position.x, push.size.x);
  vec4 v = FETCH(value, VALUE_STRIDE * at + VALUE_WEIGHT), g = FETCH(value, VALUE_STRIDE * at + VALUE_CHROMA);
  vec4 s = FETCH(value, VALUE_STRIDE * at + VALUE_TARGET), screen = v + g, pull = v * s, mean = vec4(0.0);
  vec4 gate = vec4(0.0), kept = vec4(0.0), around = FETCH(wide, tile);
  float quiet = kAnchored ? max(0.0, 1.0 - 2.0 * FETCH1(tiles, tile)) : 0.0;
  quiet *= quiet * (kAnchored ? FETCH(verdict, 0).y : 0.0);
  for (uint k = 0u; k < 4u; ++k) {
    int cell = int(position.y * push.size.x + min(4u * position.x + k, push.size.x - 1u));
    vec4 guide = FETCH(cells, CELL_STRIDE * cell);
    mean = vec4(mean.yzw, guide.x);
    if (kAnchored) {
      vec4 was = FETCH(before, cell);
      gate = vec4(gate.yzw, quiet / (1.0 + mismatch(cell_state(guide, around), was, push.detail, push.chroma)));
      kept = vec4(kept.yzw, guide.x - was.w);
    }
  }
  if (kAnchored) {
    gate = MASKED(gate, inside);
    screen += push.anchor * gate;
    pull += push.anchor * gate * kept;
    s += gate * (kept - s);
  }
  STORE(terms, TERMS_STRIDE * at + TERMS_SCREEN, screen);
  STORE(terms, TERMS_STRIDE * at + TERMS_PULL, pull);
  STORE(terms, TERMS_STRIDE * at + TERMS_CHROMA, g);
  STORE(terms, TERMS_STRIDE * at + TERMS_MEAN, MASKED(mean, inside));
  STORE(start, at, s);
  vec4 pull_before = kAnchored ? gate * LOAD(force, FORCE_STRIDE * at + FORCE_PULL) : vec4(0.0);
  STORE(force, FORCE_STRIDE * at + FORCE_PULL, pull_before);
  STORE(force, FORCE_STRIDE * at + FORCE_SCREEN, screen);
}
