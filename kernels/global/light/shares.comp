// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "global/model/model.glsl"

// A pixel's indirect light E as shares of base colors, E / S = sum over k of b_k t_k and a remainder: starts from the light
// gathered from the surfaces of each, scaled to the mean of E; then multiplicative steps of non-negative least squares
// (Lee and Seung 2001), t_k <- t_k (b_k . E) / (b_k . sum over l of b_l t_l). One pixel an invocation.
layout(constant_id = 1) const int kPlanes = 4;  // of four base colors
PLANE_IN(0, frame);
PLANE_IN(1, tints);
WORD_IN(2, slots);
PLANE_IN(3, fields);
PLANE_IN(4, bases);  // as the lamps color them; so is light
PLANE_IN(5, light);
PLANE_IN(6, scene);
PLANE_IN(7, light_state);  // light.glsl
PLANE_OUT(8, share0);
PLANE_OUT(9, share1);
PLANE_OUT(10, share2);
PLANE_OUT(11, share3);
layout(push_constant) uniform Push {
  SIZES
  uint first_row;
} push;

const int kSteps = 3;
const float kLeast = 1e-6;

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, push.first_row);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  vec2 tint;
  TINT_AT(tint, tints, at)
  vec3 white = color_of(FETCH(scene, SCENE_WHITE).xy);
  int label = int(FETCH1(slots, bin_of(chroma_of(in_white_light(sanitize(FETCH(frame, n).rgb) / white, FETCH(light_state, LIGHT_NOW))) - tint)));

  float fine = 2.0 * float(push.factor);
  vec2 u = between(at.x, fine, push.coarse.x), v = between(at.y, fine, push.coarse.y);
  ivec2 low = ivec2(u.x, v.x), high = min(low + 1, push.coarse - 1);
  ivec4 around = ivec4(low.y * push.coarse.x + ivec2(low.x, high.x), high.y * push.coarse.x + ivec2(low.x, high.x));
  int count = push.coarse.x * push.coarse.y;
  vec4 t[4];
  vec3 sum = vec3(0.0);
  for (int q = 0; q < 4; ++q) {
    t[q] = vec4(0.0);
    if (q >= kPlanes) continue;
    ivec4 field = around + (label * (kSlots / 4) + q) * count;
    t[q] = mix(mix(FETCH(fields, field.x), FETCH(fields, field.y), u.y),
               mix(FETCH(fields, field.z), FETCH(fields, field.w), u.y), v.y);
    for (int k = 0; k < 4; ++k) sum += t[q][k] * FETCH(bases, 4 * q + k).rgb;
  }
  vec4 own = FETCH(light, n);
  vec3 indirect = own.rgb - white * own.w;
  float scale = mean3(indirect) / max(mean3(sum), kLeast);
  for (int q = 0; q < kPlanes; ++q) t[q] *= scale;
  sum *= scale;
  for (int step = 0; step < kSteps; ++step) {
    vec3 next = vec3(0.0);
    for (int q = 0; q < kPlanes; ++q)
      for (int k = 0; k < 4; ++k) {
        vec3 base = FETCH(bases, 4 * q + k).rgb;
        t[q][k] *= dot(base, indirect) / max(dot(base, sum), kLeast);
        next += t[q][k] * base;
      }
    sum = next;
  }
  STORE(share0, BY_ROWS(n), t[0]);
  if (kPlanes > 1) STORE(share1, BY_ROWS(n), t[1]);
  if (kPlanes > 2) STORE(share2, BY_ROWS(n), t[2]);
  if (kPlanes > 3) STORE(share3, BY_ROWS(n), t[3]);
}
