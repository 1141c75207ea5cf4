// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "edit/edit.glsl"
#include "tone.glsl"

// A tone curve f on shading, in stops x = log2 S - middle:  S' = S 2^(strength matte (f(x) - x)).
// Black stays black, and a pixel darker than the floor gets the gain of the floor.
layout(constant_id = 1) const bool MATTE = false;
layout(constant_id = 2) const bool MEASURED = false;  // middle is that of level.comp
PLANE_IN(0, intrinsic);
PLANE_IN(1, mask);
PLANE_IN(2, curve);  // control points: x, f, df/dx, -
PLANE_IN(3, level);
PLANE_OUT(4, edited);
layout(push_constant) uniform Push {
  uvec2 size;
  float middle;  // log2 S
  float strength;
  int points;
  uint first_row;
} push;

const int kMaxPoints = 16;
const float kMaxGain = 60.0;  // stops

// The cubic between two points, a line beyond the first and the last.
float tone(float x) {
  int k = 0;
  for (int jump = kMaxPoints / 2; jump > 0; jump /= 2)
    if (k + jump < push.points && x >= FETCH(curve, k + jump).x) k += jump;
  vec4 from = FETCH(curve, k);
  float off = x - from.x;
  if (off < 0.0 || k + 1 >= push.points) return from.y + from.z * off;
  vec4 to = FETCH(curve, k + 1);
  float h = to.x - from.x, t = off / h, rise = to.y - from.y;
  float a = h * from.z, b = h * to.z;
  return from.y + t * (a + t * (3.0 * rise - 2.0 * a - b + t * (a + b - 2.0 * rise)));
}

void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y * kRows);
  if (at.x >= push.size.x) return;
  float middle = MEASURED ? FETCH(level, 0).x : push.middle;
  uint last = min(at.y + kRows, push.size.y);
  for (uint y = at.y; y < last; ++y) {
    uint n = y * push.size.x + at.x;
    vec4 layers = finite(FETCH(intrinsic, int(n)));
    float x = log2(max(layers.w, kShadingFloor)) - middle;
    float share = push.strength * (MATTE ? min(finite(FETCH(mask, int(n))).x, 1.0) : 1.0);
    float gain = share * clamp(tone(x) - x, -kMaxGain, kMaxGain);
    STORE(edited, BY_ROWS(n), vec4(layers.rgb, min(layers.w * exp2(gain), kLargest)));
  }
}
