// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"
#include "global/model/model.glsl"
#include "residual.glsl"

// Divides the tint of light out of the frame, I / tau, for the energy of intrinsicdecomp; and writes the color of light tau with
// the mean of the gathered indirect light. Four adjacent pixels an invocation.
layout(constant_id = 1) const bool kWide = false;  // all four lie between the same points of the grid
PLANE_IN(0, frame);
SCALAR_IN(1, memory);
PLANE_IN(2, tints);
WORD_IN(3, slots);
PLANE_IN(4, received);
PLANE_IN(5, smooth_part);   // fit.comp, first pass
PLANE_IN(6, coefficients);  // last pass
PLANE_IN(7, scene);
PLANE_IN(8, light_state);  // light.glsl
PLANE_OUT(9, plain);
PLANE_OUT(10, light);
layout(push_constant) uniform Push {
  SIZES
  float white_level, residual_sigma, tint_sigma;
  uint first_row;
} push;

const float kMinTau = 0.02;  // of a channel

#define AROUND(name, where) name[0] = FETCH(where, around.x); name[1] = FETCH(where, around.y); \
  name[2] = FETCH(where, around.z); name[3] = FETCH(where, around.w);
#define BLEND(name) mix(mix(name[0], name[1], u.y), mix(name[2], name[3], u.y), v.y)

void main() {
  ivec2 first = ivec2(grid_position(uint(push.size.x + 3) / 4u)) * ivec2(4, 1) + ivec2(0, push.first_row);
  if (first.y >= push.size.y) return;
  vec4 known = FETCH(scene, SCENE_AMOUNT), statistics = FETCH(scene, SCENE_TINT);
  bool cut = FETCH(scene, SCENE_TIME)[TIME_CUT] > 0.0;
  vec4 lamps = FETCH(scene, SCENE_WHITE), now = FETCH(light_state, LIGHT_NOW);
  vec3 white = color_of(lamps.xy);
  vec2 v = between(first.y, float(push.factor), push.grid.y);
  vec4 tint_at[4], smooth_at[4], fit_at[4];
  int last = min(first.x + 4, push.size.x);
  for (int x = first.x; x < last; ++x) {
    int n = first.y * push.size.x + x;
    vec3 tau = vec3(1.0), indirect = vec3(0.0);
    vec4 pixel = FETCH(frame, n);
    vec3 rgb = sanitize(pixel.rgb) / white;
    if (known[AMOUNT_KAPPA] > 0.0) {
      vec2 u = between(x, float(push.factor), push.grid.x);
      if (!kWide || x == first.x) {
        ivec2 low = ivec2(u.x, v.x), high = min(low + 1, push.grid - 1);
        ivec4 around = ivec4(low.y * push.grid.x + ivec2(low.x, high.x), high.y * push.grid.x + ivec2(low.x, high.x));
        AROUND(tint_at, tints)
        AROUND(smooth_at, smooth_part)
        AROUND(fit_at, coefficients)
      }
      vec3 own = in_white_light(rgb, now);
      float shading = cut ? shading_guessed(own, push.white_level) : shading_before(own, FETCH1(memory, n));
      vec2 z = chroma_of(own);
      int label = int(FETCH1(slots, bin_of(z - BLEND(tint_at).xy)));
      RECEIVED(indirect, label, x, first.y, 2.0 * float(push.factor))
      indirect = known[AMOUNT_KAPPA] * colored_by(lamps.z, indirect);
      if (known[AMOUNT_COLORS] > 1.5) {  // a frame of one color does not determine that of its light
        vec2 tint = chroma_of(light_of(shading, indirect));
        float fraction = fraction_of(shading, indirect);
        vec2 e = z - tint - FETCH(scene, SCENE_COLORS + label).xy;
        e = mix(BLEND(smooth_at).xy, e, light_confidence(e, fraction, statistics[TINT_RMS], push.residual_sigma, push.tint_sigma));
        vec4 fit = BLEND(fit_at);
        tau = color_of(tint + statistics[TINT_RESIDUAL] * min(1.0, 3.0 * fraction) * (fit.xy * e + fit.zw));
      }
    }
    tau = max(tau, max(vec3(kMinTau), rgb / kMaxLight));  // bounded as in the solve, so that R S tau stays the frame
    STORE(plain, BY_ROWS(n), vec4(rgb / tau, pixel.w));
    STORE(light, BY_ROWS(n), vec4(tau, mean3(indirect)));
  }
}
