// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/energy/energy.glsl"
#include "camera/same_surface.glsl"

// Changes the weight b of even shading at edges by the factors of surfaces.comp; not where something is in front of these surfaces. To be
// run once on edges as the prior has written them. One pack of pixels an invocation.
SCALAR_IN(0, factors);      // of the edges of a view
SCALAR_IN(1, known_depth);  // of the view
SCALAR_IN(2, depth);        // of the frame, from the same place
PLANE_IN(3, valid);
PLANE_IN(4, level0);
PLANE_INOUT(5, system);
PLANE_IN(6, flux);
#define TILE_CONSTANT 1
#define TILE_BINDING 7
#include "image/tiles/tile_position.glsl"
layout(push_constant) uniform Push {
  uvec2 size;    // of the frame
  uvec2 view;    // which shows the same
  float weight;  // of the change; 0: none
} push;

const float kEqual = 1e-3;  // step of m below which the flux says less of a

bool in_front(int at) {
  float here = FETCH1(depth, at), there = FETCH1(known_depth, at);
  return here > 0.0 && here < there && !same_surface(here, there);
}

// Of the edge from a pixel in the direction d: that of the edge of the view nearest to its middle; exact.
float factor(ivec2 pixel, ivec2 d) {
  ivec2 view = ivec2(push.view), size = ivec2(push.size);
  ivec2 from = min(max((2 * pixel + 1 + d) * view - d * size, ivec2(0)) / (2 * size), max(view - 1 - d, ivec2(0)));
  ivec2 to = min(from + d, view - 1);
  int at = from.y * view.x + from.x, there = to.y * view.x + to.x;
  float value = FETCH1(factors, 2 * at + d.y);
  return in_front(at) && in_front(there) ? 1.0 : exp(push.weight * value);
}

void edge(uint weight_at, int flux_at, uvec2 position, ivec2 d, vec4 step) {
  vec4 weight = LOAD(system, weight_at), flux_now = FETCH(flux, flux_at), factors = vec4(0.0);
  for (uint k = 0u; k < 4u; ++k) factors = vec4(factors.yzw, factor(ivec2(4u * position.x + k, position.y), d));
  vec4 square = step * step + kEqual * kEqual;
  vec4 a = clamp((flux_now * step + 0.5 * kEqual * kEqual * weight) / square, vec4(0.0), weight);
  STORE(system, weight_at, a + factors * (weight - a));
}

void main() {
  uint packs = PACK4(push.size.x);
  uvec2 position = tile_position(packs);
  if (position.y >= push.size.y || !(FETCH(valid, 0).x > 0.0)) return;
  int at = int(position.y * packs + position.x);
  bool last_row = position.y + 1u >= push.size.y;
  vec4 m, down;
  float right = 0.0;
  for (uint k = 0u; k < 4u; ++k) {
    uint x = min(4u * position.x + k, push.size.x - 1u);
    int pixel = int(position.y * push.size.x + x);
    m[k] = FETCH(level0, pixel).x;
    down[k] = last_row ? m[k] : FETCH(level0, pixel + int(push.size.x)).x;
    right = x + 1u < push.size.x ? FETCH(level0, pixel + 1).x : m[k];
  }
  edge(SYSTEM_FINE_STRIDE * uint(at) + SYSTEM_RIGHT, FLUX_STRIDE * at + FLUX_RIGHT, position, ivec2(1, 0),
       m - SHIFT_LEFT(m, vec4(right)));
  edge(SYSTEM_FINE_STRIDE * uint(at) + SYSTEM_DOWN, FLUX_STRIDE * at + FLUX_DOWN, position, ivec2(0, 1), m - down);
}
