#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "../intrinsic/quad.glsl"
#include "global.glsl"

// Light as an indirect layer and white direct light, whose sum has the tint and, with the reflectance, makes the frame. Four
// pixels an invocation.
PLANE_IN(0, frame);
PLANE_IN(1, intrinsic);  // of the frame without tint: .w its shading
PLANE_IN(2, tints);
PLANE_IN(3, received);
PLANE_IN(4, base);
PLANE_IN(5, scene);
PLANE_OUT(6, layers);       // E, T0
PLANE_OUT(7, reflectance);  // I / (E + T0); w: mean of E + T0
layout(push_constant) uniform Push {
  uvec2 size;
  uint factor;
} push;

void main() {
  uvec2 at = grid_position(QUADS(push.size.x));
  if (at.y >= push.size.y) return;
  uvec2 half_size = ((push.size + push.factor - 1u) / push.factor + 1u) / 2u;
  float amount = FETCH(scene, SCENE_AMOUNT).x;
  bool gray = FETCH(base, int(kSlots)).x < 2.0;
  uint count = min(push.size.x - 4u * at.x, 4u);
  for (uint k = 0u; k < count; ++k) {
    uvec2 here = uvec2(4u * at.x + k, at.y);
    uint pixel = here.y * push.size.x + here.x;
    vec4 tint = FETCH(tints, int(pixel)), solved = FETCH(intrinsic, int(pixel));
    vec3 color = color_of(tint.xy), light = solved.w * color;
    vec4 shares;
    ivec4 around = points_around(here, 2u * push.factor, half_size, shares) + int(uint(tint.z) * half_size.x * half_size.y);
    vec3 gathered = amount * BLEND(received, around, shares).rgb;
    if (gray) gathered = vec3(mean_of(gathered));
    float direct = min(split_light(mean_of(light), gathered).x, min(min(light.r, light.g), light.b));
    STORE(layers, pixel, vec4(light - direct, direct));
    STORE(reflectance, pixel, vec4(sanitize(FETCH(frame, int(pixel)).rgb) / max(light, 1e-9), mean_of(light)));
  }
}
