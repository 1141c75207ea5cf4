#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "../intrinsic/quad.glsl"
#include "global.glsl"

// Light as an indirect layer and white direct light, whose sum has the tint and, with the reflectance, makes the frame. One pixel an
// invocation.
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
  uvec2 at = grid_position(push.size.x);
  if (at.y >= push.size.y) return;
  uvec2 half_size = ((push.size + push.factor - 1u) / push.factor + 1u) / 2u;
  uint pixel = at.y * push.size.x + at.x;
  vec4 tint = FETCH(tints, int(pixel));
  vec3 light = FETCH(intrinsic, int(pixel)).w * color_of(tint.xy);
  vec4 shares;
  ivec4 around = points_around(at, 2u * push.factor, half_size, shares) + int(uint(tint.z) * half_size.x * half_size.y);
  vec3 gathered = FETCH(scene, SCENE_AMOUNT).x * BLEND(received, around, shares).rgb;
  if (FETCH(base, int(kSlots)).x < 2.0) gathered = vec3(mean_of(gathered));
  float direct = min(split_light(mean_of(light), gathered).x, min(min(light.r, light.g), light.b));
  STORE(layers, pixel, vec4(light - direct, direct));
  STORE(reflectance, pixel, vec4(sanitize(FETCH(frame, int(pixel)).rgb) / max(light, 1e-9), mean_of(light)));
}
