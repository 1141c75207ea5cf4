#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"
#include "guide.glsl"
#include "temporal.glsl"

layout(constant_id = 1) const bool kAnchored = false;
PLANE_IN(0, frame);
PLANE_INOUT(1, shading);
PLANE_IN(2, cells);
PLANE_IN(3, wide);
PLANE_IN(4, gauge);  // .x = ln c (gauge.comp)
PLANE_OUT(5, intrinsic);
PLANE_INOUT(6, kept);
PLANE_IN(7, start);
PLANE_IN(8, level0);
PLANE_INOUT(9, memory);
layout(push_constant) uniform Push { uvec2 size; float texture; float luma; } push;

uint quads = QUADS(push.size.x);
float keep_at(int x, int y) {
  return FETCH(start, 3 * (y * int(QUADS(quads)) + x / 4) + 2)[x & 3];
}
vec4 row_keep(int y, int dx0, int x, int dx1) {
  return vec4(0.0);
}

void main() {
  uvec2 cell = grid_position(quads);
  uint first = 4u * cell.y;
  if (first >= push.size.y) return;
  uvec2 count = min(push.size - 4u * cell, uvec2(4u));
  float scale = FETCH(gauge, 0).x;
  uint at = cell.y * quads + cell.x;
  vec4 guide = FETCH(cells, int(CELL_STRIDE * at));
  float change = 0.0;
  vec3 keeps[3];
  if (kAnchored) {
    change = guide.x - LOAD(kept, at).w;
    ivec2 c = ivec2(cell), last = ivec2(quads, (push.size.y + 3u) / 4u) - 1;
    for (int j = 0; j < 3; ++j) {
      int y = clamp(c.y + j - 1, 0, last.y);
      keeps[j] = vec3(keep_at(max(c.x - 1, 0), y), keep_at(c.x, y), keep_at(min(c.x + 1, last.x), y));
    }
  }
  for (uint y = 0u; y < count.y; ++y) {
    uint quad = (first + y) * quads + cell.x;
    vec4 s = LOAD(shading, quad), m = vec4(0.0), l = vec4(0.0);
    for (uint x = 0u; x < 4u; ++x) {
      vec4 g = FETCH(level0, int((first + y) * push.size.x + min(4u * cell.x + x, push.size.x - 1u)));
      m = vec4(m.yzw, g.x);
      l = vec4(l.yzw, mix(g.x, luma(g), push.luma));
    }
    vec4 r = l - s;
    if (kAnchored) {
      float f = 0.25 * (float(y) + 0.5) - 0.5;
      vec3 k = f < 0.0 ? mix(keeps[1], keeps[0], -f) : mix(keeps[1], keeps[2], f);
      vec4 keep = vec4(mix(k.y, k.x, 0.375), mix(k.y, k.x, 0.125), mix(k.y, k.z, 0.125), mix(k.y, k.z, 0.375));
      vec4 off = push.texture * (m - LOAD(memory, 2u * quad) - change);
      keep /= 1.0 + off * off;
      r += keep * (LOAD(memory, 2u * quad + 1u) - r);
      s = l - r;
      STORE(shading, quad, MASKED(s, INSIDE(cell.x, push.size.x)));
    }
    STORE(memory, 2u * quad, m);
    STORE(memory, 2u * quad + 1u, r);
    for (uint x = 0u; x < count.x; ++x) {
      uint pixel = (first + y) * push.size.x + 4u * cell.x + x;
      vec3 rgb = sanitize(FETCH(frame, int(pixel)).rgb);
      STORE(intrinsic, pixel, vec4(rgb * exp(scale - s.x), exp(s.x - scale)));
      s = s.yzwx;
    }
  }
  STORE(kept, at, cell_state(guide, FETCH(wide, int((cell.y / 4u) * QUADS(quads) + cell.x / 4u))));
}
