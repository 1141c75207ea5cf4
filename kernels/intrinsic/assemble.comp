#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"
#include "guide.glsl"
#include "temporal.glsl"

// What stays the same of the system for a whole frame, and where the solve starts: mass, base and s of energy.glsl from
// the prior and, with kAnchored, the frame before. One quad an invocation.
layout(constant_id = 1) const bool kAnchored = false;
PLANE_IN(0, flux);
PLANE_IN(1, value);
PLANE_IN(2, level0);
PLANE_IN(3, cells);
PLANE_IN(4, before);
SCALAR_IN(5, blocks);
PLANE_IN(6, verdict);
PLANE_OUT(7, system);
PLANE_OUT(8, base);
PLANE_OUT(9, shading);
layout(push_constant) uniform Push {
  uvec2 size;
  float anchor;
  float detail;
  float chroma;
} push;

void main() {
  uint quads = QUADS(push.size.x);
  uvec2 position = grid_position(quads);
  if (position.y >= push.size.y) return;
  int at = int(position.y * quads + position.x);
  vec4 v = FETCH(value, VALUE_STRIDE * at + VALUE_WEIGHT), start = FETCH(value, VALUE_STRIDE * at + VALUE_TARGET);
  vec4 mass = v + FETCH(value, VALUE_STRIDE * at + VALUE_CHROMA), sum = v * start;
  if (kAnchored) {
    bvec4 inside = INSIDE(position.x, push.size.x);
    float cell_mean = FETCH(cells, int(CELL_STRIDE * ((position.y / 4u) * quads + position.x))).x;
    uint block_columns = (push.size.x + 7u) / 8u;
    float quiet = max(0.0, 1.0 - 2.0 * FETCH1(blocks, int((position.y / 8u) * block_columns + position.x / 2u)));
    quiet *= quiet * FETCH(verdict, 0).y;
    vec4 gate = vec4(0.0), kept = vec4(0.0);
    for (uint k = 0u; k < 4u; ++k) {
      int pixel = int(position.y * push.size.x + min(4u * position.x + k, push.size.x - 1u));
      vec4 guide = FETCH(level0, pixel), was = FETCH(before, pixel);
      float q = mismatch(guide, cell_mean, was, Change(push.detail, push.chroma));
      gate = vec4(gate.yzw, quiet / (1.0 + q));
      kept = vec4(kept.yzw, guide.x - was.w);
    }
    gate = MASKED(gate, inside);
    mass += push.anchor * gate;
    sum += push.anchor * gate * kept;
    start += gate * (kept - start);
  }
  vec4 right = FETCH(flux, FLUX_STRIDE * at + FLUX_RIGHT);
  float left = position.x > 0u ? FETCH(flux, FLUX_STRIDE * (at - 1) + FLUX_RIGHT).w : 0.0;
  sum += right - SHIFT_RIGHT(right, vec4(left)) + FETCH(flux, FLUX_STRIDE * at + FLUX_DOWN);
  if (position.y > 0u) sum -= FETCH(flux, FLUX_STRIDE * (at - int(quads)) + FLUX_DOWN);
  STORE(system, SYSTEM_STRIDE * at + SYSTEM_MASS, mass);
  STORE(base, at, sum);
  STORE(shading, at, start);
}
