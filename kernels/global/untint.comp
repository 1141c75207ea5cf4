#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "model.glsl"
#include "residual.glsl"

// The frame without the tint of its light, I / tau, which intrinsicdecomp's energy then takes apart; and the light's color
// tau with the mean of the indirect light that was gathered. One pixel an invocation.
PLANE_IN(0, frame);
SCALAR_IN(1, memory);
PLANE_IN(2, tints);
WORD_IN(3, slots);
PLANE_IN(4, received);
PLANE_IN(5, smooth_part);   // fit.comp, first pass
PLANE_IN(6, coefficients);  // last pass
PLANE_IN(7, scene);
PLANE_OUT(8, plain);
PLANE_OUT(9, light);
layout(push_constant) uniform Push {
  SIZES
  float gauge, trust, trust_tint;
} push;

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  vec4 pixel = FETCH(frame, n);
  vec3 rgb = sanitize(pixel.rgb);
  float shading = FETCH(scene, SCENE_TIME).x > 0.0 ? shading_guessed(rgb, push.gauge)
                                                   : shading_before(rgb, FETCH1(memory, n));
  vec2 u = between(at.x, float(push.factor), push.grid.x), v = between(at.y, float(push.factor), push.grid.y);
  ivec2 low = ivec2(u.x, v.x), high = min(low + 1, push.grid - 1);
  ivec4 around = ivec4(low.y * push.grid.x + ivec2(low.x, high.x), high.y * push.grid.x + ivec2(low.x, high.x));
#define BLEND(name) \
  mix(mix(FETCH(name, around.x), FETCH(name, around.y), u.y), mix(FETCH(name, around.z), FETCH(name, around.w), u.y), v.y)
  vec2 z = chroma_of(rgb);
  int label = int(FETCH1(slots, bin_of(z - BLEND(tints).xy)));
  vec3 indirect;
  RECEIVED(indirect, label, at.x, at.y, 2.0 * float(push.factor))
  vec4 known = FETCH(scene, SCENE_AMOUNT), statistics = FETCH(scene, SCENE_TINT);
  indirect *= known.x;
  vec3 tau = vec3(1.0);
  if (known.w > 1.5) {  // a frame of one color says nothing of its light's
    vec2 tint = chroma_of(light_of(shading, indirect));
    float fraction = fraction_of(shading, indirect);
    vec2 e = z - tint - FETCH(scene, SCENE_COLORS + label).xy;
    e = mix(BLEND(smooth_part).xy, e, belief(e, fraction, statistics.x, push.trust, push.trust_tint));
    vec4 fit = BLEND(coefficients);
    tau = color_of(tint + statistics.y * min(1.0, 3.0 * fraction) * (fit.xy * e + fit.zw));
  }
  STORE(plain, n, vec4(rgb / max(tau, 0.02), pixel.w));
  STORE(light, n, vec4(tau, mean3(indirect)));
}
