// SPDX-License-Identifier: LGPL-2.1-or-later
// Shared by the recolor kernels: R' = R + w (R_target − R_object), with
//
//   R_object = R − δ (1 − matte) / matte, δ the reflectance of what is behind the object minus R, in the mask (matte.hpp)
//   R_target = target · (mean R_object / value K of the key)^texture · (K / mean target)^brightness, or R_object to change its hue only;
//              its hue is turned
//   w        = strength · selection · matte
//
// So a pixel at the object's edge keeps its share of what is behind. The including kernel defines the selection.
#include "edit.glsl"

layout(constant_id = 1) const bool MATTE = false;    // multiply by the mask layer
layout(constant_id = 2) const bool PUBLISH = false;  // write selection · matte as the mask layer

PLANE_IN(0, intrinsic);
PLANE_IN(1, mask);
PLANE_OUT(2, edited);
PLANE_OUT(3, published);
layout(push_constant) uniform Push {
  vec4 target;  // linear RGB; w = strength
  vec4 key;     // chromaticity K / mean K; w = mean K + kValueFloor
  vec2 turn;    // of hue: cosine, and sine / √3
  uvec2 size;
  float texture_kept;
  float brightness_kept;
  float own_color;  // 1: of the surface; 0: `target`
  float tolerance;
  float value_tolerance;
  float fall_off;  // 1 / softness
  int clusters;    // how many there are
  int cluster;     // the one to recolor
  uint first_row;
} push;

// Mean reflectance below which values are not distinguished: a coal cellar has 0.02.
const float kValueFloor = 1e-3;

// Least matte by which light behind an object is taken off.
const float kMinMatte = 0.1;

// Turned around the axis of grays in linear RGB, which keeps the mean of the channels. Channels below 0 become 0.
vec3 turned(vec3 color) {
  vec3 across = color.brg - color.gbr;  // (1, 1, 1) × color
  return max(push.turn.x * color + (1.0 - push.turn.x) * mean3(color) + push.turn.y * across, vec3(0.0));
}

void recolor(uint n, vec4 layers, float selection, float key_value) {
  vec3 object = layers.rgb;
  if (MATTE) {
    vec4 seen = FETCH(mask, int(n));
    float matte = min(finite(seen).x, 1.0);
    vec3 behind = mix(vec3(0.0), seen.yzw, lessThan(abs(seen.yzw), vec3(kLargest)));
    object = clamp(object - (1.0 - matte) / max(matte, kMinMatte) * behind, vec3(0.0), vec3(kLargest));
    selection *= matte;
  }
  if (PUBLISH) STORE(published, BY_ROWS(n), vec4(selection, 0.0, 0.0, 0.0));
  float ratio = (mean3(object) + kValueFloor) / key_value, value = key_value / (mean3(push.target.rgb) + kValueFloor);
  vec3 target = push.own_color > 0.0 ? object
                                     : push.target.rgb * exp(push.texture_kept * log(ratio) + push.brightness_kept * log(value));
  target = turned(target);
  vec3 changed = clamp(layers.rgb + push.target.w * selection * (target - object), vec3(0.0), vec3(kLargest));
  STORE(edited, BY_ROWS(n), vec4(changed, layers.w));
}
