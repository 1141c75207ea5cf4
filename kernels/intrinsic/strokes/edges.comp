// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/energy/energy.glsl"
#include "image/strokes/strokes.glsl"

const float kStrokeWeight = 1000.0;  // added to the weight of an edge inside a stroke

// Edges inside a stroke, with w the smaller weight of their two pixels, and W = kStrokeWeight:
//
//   (1 - w) (a (ds - dm)^2 + b ds^2) + w (a + b + W) (ds - d)^2,   d = 0 in a stroke of constant shading, dm of constant reflectance
//
// so that their weight grows by w W, and their flux becomes (1 - w) flux + w (a + b + W) d. To be run once on edges as the prior
// has written them. One pack of pixels an invocation.
PLANE_IN(0, mask);
PLANE_IN(1, strokes);
PLANE_IN(2, level0);
PLANE_INOUT(3, system);
PLANE_INOUT(4, flux);
#define TILE_CONSTANT 1
#define TILE_BINDING 5
#include "image/tiles/tile_position.glsl"
layout(push_constant) uniform Push { uvec2 size; } push;

void edge(uint weight_at, uint flux_at, vec4 here, vec4 next, vec4 step) {
  vec4 w = mix(vec4(0.0), min(weight_of(here), weight_of(next)), equal(number_of(here), number_of(next)));
  if (all(equal(w, vec4(0.0)))) return;
  vec4 target;
  for (int k = 0; k < 4; ++k) {
    int kind = w[k] > 0.0 ? int(FETCH(strokes, STROKE_STRIDE * (int(here[k]) - 1) + STROKE_KIND).x) : KIND_SHADING;
    target[k] = kind == KIND_REFLECTANCE ? step[k] : 0.0;
  }
  vec4 weight = LOAD(system, weight_at), old = LOAD(flux, flux_at);
  STORE(system, weight_at, weight + w * kStrokeWeight);
  STORE(flux, flux_at, mix(old, (weight + kStrokeWeight) * target, w));
}

void main() {
  uint packs = PACK4(push.size.x);
  uvec2 position = tile_position(packs);
  if (position.y >= push.size.y) return;
  int at = int(position.y * packs + position.x);
  vec4 here = FETCH(mask, at);
  if (all(equal(here, vec4(0.0)))) return;
  bool last_row = position.y + 1u >= push.size.y;
  vec4 below = last_row ? vec4(0.0) : FETCH(mask, at + int(packs));
  float beside = position.x + 1u < packs ? FETCH(mask, at + 1).x : 0.0;
  vec4 m, down;
  float right = 0.0;
  for (uint k = 0u; k < 4u; ++k) {
    uint x = min(4u * position.x + k, push.size.x - 1u);
    int pixel = int(position.y * push.size.x + x);
    m[k] = FETCH(level0, pixel).x;
    down[k] = last_row ? m[k] : FETCH(level0, pixel + int(push.size.x)).x;
    right = x + 1u < push.size.x ? FETCH(level0, pixel + 1).x : m[k];
  }
  edge(SYSTEM_FINE_STRIDE * uint(at) + SYSTEM_RIGHT, FLUX_STRIDE * uint(at) + FLUX_RIGHT, here, SHIFT_LEFT(here, vec4(beside)),
       m - SHIFT_LEFT(m, vec4(right)));
  edge(SYSTEM_FINE_STRIDE * uint(at) + SYSTEM_DOWN, FLUX_STRIDE * uint(at) + FLUX_DOWN, here, below, m - down);
}
