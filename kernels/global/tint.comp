#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "../intrinsic/quad.glsl"
#include "../intrinsic/temporal.glsl"
#include "global.glsl"

// Divides the tint of the light out of the frame. One quad of pixels an invocation.
layout(constant_id = 1) const bool kCoarse = false;  // the four pixels lie between the same points of the grid
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
  uint quads = QUADS(push.size.x);
  uvec2 at = grid_position(quads);
  if (at.y >= push.size.y) return;
  uvec2 grid = (push.size + push.factor - 1u) / push.factor, half_size = (grid + 1u) / 2u;
  int quad = int(at.y * quads + at.x);
  vec4 before = FETCH(shading, quad) - FETCH(memory, MEMORY_STRIDE * quad + MEMORY_MEAN) - FETCH(gauge, 0).x;
  float amount = FETCH(scene, SCENE_AMOUNT).x;
  vec2 statistics = FETCH(scene, SCENE_STATISTICS).xy;
  bool anew = FETCH(scene, SCENE_STATE).x > 0.0;
  bool gray = FETCH(base, int(kSlots)).x < 2.0;  // one color says nothing
  uint count = min(push.size.x - 4u * at.x, 4u);
  vec4 shares, mean_at[4], model_at[4];
  ivec4 around = points_around(uvec2(4u * at.x, at.y), push.factor, grid, shares);
  if (kCoarse)
    for (int j = 0; j < 4; ++j) {
      mean_at[j] = FETCH(means, around[j]);
      model_at[j] = FETCH(models, around[j]);
    }
  for (uint k = 0u; k < count; ++k) {
    uvec2 here = uvec2(4u * at.x + k, at.y);
    uint pixel = here.y * push.size.x + here.x;
    vec4 color = FETCH(frame, int(pixel));
    vec3 rgb = sanitize(color.rgb), floored = rgb + kFloor;
    float m = log(floored.r * floored.g * floored.b) / 3.0;
    float light = anew ? brightest_of(rgb) / kBrightest : exp(m + before.x);
    before = before.yzwx;

    around = points_around(here, push.factor, grid, shares);
    vec2 z = chroma_of(rgb);
    vec4 mean = kCoarse ? MIXED(mean_at, shares) : BLEND(means, around, shares);
    uint label = FETCH1(table, int(bin_at(z - mean.xy)));
    vec4 model = kCoarse ? MIXED(model_at, shares) : BLEND(models, around, shares);
    around = points_around(here, 2u * push.factor, half_size, shares) + int(label * half_size.x * half_size.y);
    vec3 tint = tint_of(light, amount * BLEND(received, around, shares).rgb);
    vec2 e = z - tint.xy - FETCH(base, int(label)).xy;
    e = mix(mean.zw, e, belief(e, tint.z, statistics.x));
    vec2 tau = tint.xy + statistics.y * min(1.0, 3.0 * tint.z) * (model.xy * e + model.zw);
    if (gray) tau = vec2(0.0);
    STORE(plain, pixel, vec4(rgb / max(color_of(tau), 0.02), color.a));
    STORE(tints, pixel, vec4(tau, float(label), 0.0));
  }
}
