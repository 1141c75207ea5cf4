#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"
#include "guide.glsl"

// The cells' part of the system (energy.glsl), from the prior; and, with kAnchored, how far their pixels may believe the
// frame before. One quad of cells an invocation.
layout(constant_id = 1) const bool kAnchored = false;
PLANE_IN(0, value);
PLANE_IN(1, cells);
PLANE_IN(2, mismatch);
PLANE_IN(3, tiles);
PLANE_IN(4, verdict);
PLANE_IN(5, before);    // cell_state (temporal.glsl)
PLANE_OUT(6, terms);
PLANE_OUT(7, start);    // two vec4 a quad: V - (m' + u'), and the gate, 0…1
PLANE_INOUT(8, force);  // the last frame's, a good guess where this one continues it
PLANE_IN(9, means);
PLANE_IN(10, correction);
layout(push_constant) uniform Push {
  uvec2 size;    // of level 2
  float anchor;  // t where nothing moves but the light
  float still;   // how many times that is added where the light does not change either
  float carry, moving, prior, hold_still, hold_light;
  float light;   // 1 / (change of light that halves that)
} push;

void main() {
  uint quads = QUADS(push.size.x);
  uvec2 position = grid_position(quads);
  if (position.y >= push.size.y) return;
  int at = int(position.y * quads + position.x), tile = int((position.y / 4u) * quads + position.x);
  bvec4 inside = INSIDE(position.x, push.size.x);
  vec4 v = FETCH(value, VALUE_STRIDE * at + VALUE_WEIGHT), g = FETCH(value, VALUE_STRIDE * at + VALUE_CHROMA);
  vec4 target = FETCH(value, VALUE_STRIDE * at + VALUE_TARGET), mean = vec4(0.0), most = mean, gate = mean, change = mean;
  float quiet = kAnchored ? max(0.0, 1.0 - 2.0 * FETCH(tiles, tile).x) : 0.0;
  quiet *= quiet * (kAnchored ? FETCH(verdict, 0).y : 0.0);
  if (kAnchored && push.moving > 0.0) {
    ivec2 tile_size = ivec2(quads, (push.size.y + 3u) / 4u), c = ivec2(position.x, position.y / 4u);
    vec4 verdict_ = FETCH(verdict, 0);
    vec2 sum = push.prior * vec2(verdict_.z, 1.0);
    for (int y = max(c.y - 2, 0); y <= min(c.y + 2, tile_size.y - 1); ++y)
      for (int x = max(c.x - 2, 0); x <= min(c.x + 2, tile_size.x - 1); ++x)
        sum += FETCH(tiles, y * tile_size.x + x).yz;
    float M = sum.x / (max(sum.y, 1e-20) * push.moving);
    quiet /= 1.0 + M * M * M * M;
  }
  for (uint k = 0u; k < 4u; ++k) {
    int cell = int(position.y * push.size.x + min(4u * position.x + k, push.size.x - 1u));
    vec4 guide = FETCH(cells, CELL_STRIDE * cell);
    mean = vec4(mean.yzw, guide.x);
    most = vec4(most.yzw, guide.x + guide.w);
    if (kAnchored) {
      gate = vec4(gate.yzw, quiet / (1.0 + FETCH(mismatch, cell).x));
      change = vec4(change.yzw, push.light * (guide.x - FETCH(before, cell).w));
    }
  }
  STORE(terms, TERMS_STRIDE * at + TERMS_SCREEN, v + g);
  STORE(terms, TERMS_STRIDE * at + TERMS_PULL, v * target);
  STORE(terms, TERMS_STRIDE * at + TERMS_CHROMA, g);
  STORE(terms, TERMS_STRIDE * at + TERMS_MEAN, MASKED(mean, inside));
  vec4 from = target;
  if (kAnchored && push.carry > 0.0) from = mix(target, FETCH(means, at) + FETCH(correction, at), push.carry * FETCH(verdict, 0).y);
  STORE(start, 3 * at, from - most);
  STORE(start, 3 * at + 1, gate);
  STORE(start, 3 * at + 2, gate * (push.hold_light + (push.hold_still - push.hold_light) / (1.0 + change * change)));
  vec4 pull_before = kAnchored ? gate * LOAD(force, FORCE_STRIDE * at + FORCE_PULL) : vec4(0.0);
  STORE(force, FORCE_STRIDE * at + FORCE_PULL, MASKED(pull_before, inside));
  STORE(force, FORCE_STRIDE * at + FORCE_SCREEN, v + g);
  STORE(force, FORCE_STRIDE * at + FORCE_ANCHOR, push.anchor * MASKED(gate * (1.0 + push.still / (1.0 + change * change)), inside));
}
