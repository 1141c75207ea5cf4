#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "../intrinsic/quad.glsl"
#include "../intrinsic/temporal.glsl"
#include "global.glsl"

// Divides the tint of the light out of the frame. One pixel an invocation.
PLANE_IN(0, frame);
PLANE_IN(1, memory);    // m of the frame before
PLANE_IN(2, shading);   // and its s
PLANE_IN(3, gauge);
PLANE_IN(4, scene);
PLANE_IN(5, means);     // tint of the light on the grid; residuals there
PLANE_IN(6, models);
PLANE_IN(7, received);
WORD_IN(8, table);
PLANE_IN(9, base);
PLANE_OUT(10, plain);   // I'; w as in the frame
PLANE_OUT(11, tints);   // log chroma of the light; base color
layout(push_constant) uniform Push {
  uvec2 size;
  uint factor;
} push;

void main() {
  uvec2 at = grid_position(push.size.x);
  if (at.y >= push.size.y) return;
  uvec2 grid = (push.size + push.factor - 1u) / push.factor, half_size = (grid + 1u) / 2u;
  uint pixel = at.y * push.size.x + at.x;
  vec4 input_color = FETCH(frame, int(pixel));
  vec3 rgb = sanitize(input_color.rgb), floored = rgb + kFloor;
  int quad = int(at.y * QUADS(push.size.x) + at.x / 4u);
  float m = log(floored.r * floored.g * floored.b) / 3.0;
  float before = FETCH(shading, quad)[at.x & 3u] - FETCH(memory, MEMORY_STRIDE * quad + MEMORY_MEAN)[at.x & 3u];
  vec4 state = FETCH(scene, SCENE_STATE), amount = FETCH(scene, SCENE_AMOUNT);
  float light = state.x > 0.0 ? brightest_of(rgb) / kBrightest : exp(m + before - FETCH(gauge, 0).x);

  vec4 shares;
  ivec4 around = points_around(at, push.factor, grid, shares);
  vec2 z = chroma_of(rgb);
  vec4 mean = BLEND(means, around, shares);
  uint label = FETCH1(table, int(bin_at(z - mean.xy)));
  vec4 half_shares;
  ivec4 half_around = points_around(at, 2u * push.factor, half_size, half_shares) + int(label * half_size.x * half_size.y);
  vec3 tint = tint_of(light, amount.x * BLEND(received, half_around, half_shares).rgb);
  vec2 statistics = FETCH(scene, SCENE_STATISTICS).xy;
  vec2 e = z - tint.xy - FETCH(base, int(label)).xy;
  e = mix(mean.zw, e, belief(e, tint.z, statistics.x));
  vec4 model = BLEND(models, around, shares);
  vec2 tau = tint.xy + statistics.y * min(1.0, 3.0 * tint.z) * (model.xy * e + model.zw);
  if (FETCH(base, int(kSlots)).x < 2.0) tau = vec2(0.0);  // one color says nothing
  STORE(plain, pixel, vec4(rgb / max(color_of(tau), 0.02), input_color.a));
  STORE(tints, pixel, vec4(tau, float(label), 0.0));
}
