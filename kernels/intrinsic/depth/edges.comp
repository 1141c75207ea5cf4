// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "gpu/common.glsl"
#include "intrinsic/energy/energy.glsl"
#include "volume/jump.glsl"
#include "volume/same_surface.glsl"

// Changes the weight b of even shading at edges by the surfaces of the remembered scene on both sides: more where they are one flat
// surface, less where its normal turns, nothing across a step of depth or where a surface is not known
// (docs/reference/methods/intrinsicdecomp.md, 16). To be run once on edges as the prior has written them. One pack of pixels an
// invocation.
PLANE_IN(0, surface);  // KnownReflectance
SCALAR_IN(1, depth);
PLANE_IN(2, valid);
PLANE_IN(3, level0);
PLANE_INOUT(4, system);
PLANE_IN(5, flux);
#define TILE_CONSTANT 1
#define TILE_BINDING 6
#include "image/tiles/tile_position.glsl"
layout(push_constant) uniform Push {
  uvec2 size;    // of the frame
  uvec2 view;    // of what is known, which shows the same
  float focal;   // of that, pixels
  float weight;  // of the change; 0: none
} push;

const float kFlat = 1.2, kTurned = -0.5;     // ln of the factor on b
const float kAngle = 0.4;                    // difference of normals that is half way between them, ...
const float kNoiseAngle = 0.2;               // ... and what noise of the depth adds
const int kReach = 3;                        // pixels of the view on each side
const float kNearest = 1e-3, kFarthest = 100.0;  // meters
const float kEqual = 1e-3;                   // step of m below which the flux says less of a

// The pixel of the view that is k half pixels of it from the middle of an edge; exact.
int place(ivec2 pixel, ivec2 d, int k) {
  ivec2 view = ivec2(push.view), size = ivec2(push.size);
  ivec2 p = min(max((2 * pixel + 1 + d) * view + k * d * size, ivec2(0)) / (2 * size), view - 1);
  return p.y * view.x + p.x;
}
// Normal and depth there; 0 if they are not known.
vec4 seen(int at) {
  vec4 s = FETCH(surface, at);
  float square = dot(s.xyz, s.xyz);
  return s.w > kNearest && s.w < kFarthest && square > 0.5 && square < 2.0 ? s : vec4(0.0);
}
bool in_front(int at, float there) {
  float here = FETCH1(depth, at);
  return here > 0.0 && here < there && !same_surface(here, there);
}

// ln of the factor on b of the edge from a pixel in the direction d.
float cue(ivec2 pixel, ivec2 d) {
  int at_a = place(pixel, d, -1), at_b = place(pixel, d, 1);
  vec4 first_a = seen(at_a), first_b = seen(at_b);
  float step = abs(first_a.w - first_b.w), z = min(first_a.w, first_b.w);
  vec3 sum_a = first_a.xyz, sum_b = first_b.xyz;
  [[unroll]] for (int k = 1; k < kReach; ++k) {
    vec4 a = seen(place(pixel, d, -1 - 2 * k)), b = seen(place(pixel, d, 1 + 2 * k));
    float near = float(k + 1) * kJump;
    sum_a += abs(a.w - first_a.w) < near * first_a.w ? a.xyz : vec3(0.0);
    sum_b += abs(b.w - first_b.w) < near * first_b.w ? b.xyz : vec3(0.0);
    if (k == 1) step = max(step, max(a.w > 0.0 ? abs(a.w - first_a.w) : 0.0, b.w > 0.0 ? abs(b.w - first_b.w) : 0.0));
  }
  float square_a = dot(sum_a, sum_a), square_b = dot(sum_b, sum_b);
  bool hidden = in_front(at_a, first_a.w) && in_front(at_b, first_b.w);
  bool known = z > 0.0 && square_a > 0.0 && square_b > 0.0 && !hidden;
  vec3 turn = sum_a * inversesqrt(max(square_a, 1e-12)) - sum_b * inversesqrt(max(square_b, 1e-12));
  float angle = kAngle + kNoiseAngle * noise_at(z) * push.focal / max(z, kNearest), square = dot(turn, turn) / (angle * angle);
  float apart = smoothstep(0.6 * kJump, kJump, step / max(z, kNearest));
  return known ? (1.0 - apart) * mix(kFlat, kTurned, square / (1.0 + square)) : 0.0;
}

void edge(uint weight_at, int flux_at, uvec2 position, ivec2 d, vec4 step) {
  vec4 weight = LOAD(system, weight_at), flux_now = FETCH(flux, flux_at), factor = vec4(0.0);
  for (uint k = 0u; k < 4u; ++k) factor = vec4(factor.yzw, exp(push.weight * cue(ivec2(4u * position.x + k, position.y), d)));
  vec4 square = step * step + kEqual * kEqual;
  vec4 a = clamp((flux_now * step + 0.5 * kEqual * kEqual * weight) / square, vec4(0.0), weight);
  STORE(system, weight_at, a + factor * (weight - a));
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
