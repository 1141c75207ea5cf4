// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"
#include "global/model/model.glsl"

// The direct, white share of light, T0 / S: what the indirect light leaves of it, at most its weakest channel; its color then
// includes the lamps'. And the brightness of reflectance, for the next frame. Four adjacent pixels an invocation.
PLANE_IN(0, frame);  // without tint
PLANE_IN(1, intrinsic);
PLANE_IN(2, scene);
PLANE_IN(3, tau);     // divide_tint.comp
PLANE_OUT(4, light);  // may be the same buffer
SCALAR_OUT(5, memory);
layout(push_constant) uniform Push {
  ivec2 size;
  uint first_row;
} push;

void main() {
  ivec2 first = ivec2(grid_position(uint(push.size.x + 3) / 4u)) * ivec2(4, 1) + ivec2(0, push.first_row);
  if (first.y >= push.size.y) return;
  vec3 white = color_of(FETCH(scene, SCENE_WHITE).xy);
  int last = min(first.x + 4, push.size.x);
  for (int x = first.x; x < last; ++x) {
    int n = first.y * push.size.x + x;
    vec3 lit = sanitize(FETCH(frame, n).rgb) + kIntensityFloor;
    float shading = FETCH(intrinsic, n).w;
    STORE(memory, BY_ROWS(n), log(lit.r * lit.g * lit.b) * (1.0 / 3.0) - log(max(shading, 1e-6)));
    vec4 own = FETCH(tau, n);
    float direct = max(shading * mean3(own.rgb) - own.w, 0.0) / max(shading, 1e-12);
    STORE(light, BY_ROWS(n), vec4(white * own.rgb, min(min(direct, 1.0), min(min(own.r, own.g), own.b))));
  }
}
