// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "gpu/common.glsl"
#include "camera/jump.glsl"
#include "camera/noise.glsl"

// ln of the factor on the weight b of even shading at edges between the pixels of a view of the remembered scene: more where both sides
// are one flat surface, less where its normal turns, 0 across a step of depth or where a surface is not known
// (docs/reference/methods/intrinsicdecomp.md, 16). One pixel an invocation.
PLANE_IN(0, surface);  // KnownReflectance
SCALAR_OUT(1, factors);  // two a pixel: of its edge to the right, and down; any value at the last ones
layout(push_constant) uniform Push {
  uvec2 size;
  float focal;  // pixels
} push;

const float kFlat = 1.2, kTurned = -0.5;
const float kAngle = 0.4;                        // difference of normals that is half way between them, ...
const float kNoiseAngle = 0.2;                   // ... and what noise of the depth adds
const int kReach = 3;                            // pixels on each side
const float kNearest = 1e-3, kFarthest = 100.0;  // meters

// Normal and depth of the pixel k pixels further; 0 if they are not known.
vec4 seen(ivec2 pixel, ivec2 d, int k) {
  ivec2 p = clamp(pixel + k * d, ivec2(0), ivec2(push.size) - 1);
  vec4 s = FETCH(surface, p.y * int(push.size.x) + p.x);
  float square = dot(s.xyz, s.xyz);
  return s.w > kNearest && s.w < kFarthest && square > 0.5 && square < 2.0 ? s : vec4(0.0);
}

float factor(ivec2 pixel, ivec2 d) {
  vec4 first_a = seen(pixel, d, 0), first_b = seen(pixel, d, 1);
  float step = abs(first_a.w - first_b.w), z = min(first_a.w, first_b.w);
  vec3 sum_a = first_a.xyz, sum_b = first_b.xyz;
  [[unroll]] for (int k = 1; k < kReach; ++k) {
    vec4 a = seen(pixel, d, -k), b = seen(pixel, d, 1 + k);
    float near = float(k + 1) * kJump;
    sum_a += abs(a.w - first_a.w) < near * first_a.w ? a.xyz : vec3(0.0);
    sum_b += abs(b.w - first_b.w) < near * first_b.w ? b.xyz : vec3(0.0);
    if (k == 1) step = max(step, max(a.w > 0.0 ? abs(a.w - first_a.w) : 0.0, b.w > 0.0 ? abs(b.w - first_b.w) : 0.0));
  }
  float square_a = dot(sum_a, sum_a), square_b = dot(sum_b, sum_b);
  bool known = z > 0.0 && square_a > 0.0 && square_b > 0.0;
  vec3 turn = sum_a * inversesqrt(max(square_a, 1e-12)) - sum_b * inversesqrt(max(square_b, 1e-12));
  float angle = kAngle + kNoiseAngle * noise_at(z) * push.focal / max(z, kNearest), square = dot(turn, turn) / (angle * angle);
  float apart = smoothstep(0.6 * kJump, kJump, step / max(z, kNearest));
  return known ? (1.0 - apart) * mix(kFlat, kTurned, square / (1.0 + square)) : 0.0;
}

void main() {
  uint line = line_index();
  ivec2 pixel = ivec2(line % push.size.x, line / push.size.x);
  if (pixel.y >= int(push.size.y)) return;
  STORE(factors, 2u * line, factor(pixel, ivec2(1, 0)));
  STORE(factors, 2u * line + 1u, factor(pixel, ivec2(0, 1)));
}
