// SPDX-License-Identifier: LGPL-2.1-or-later
// Shared by the recolor kernels: R' = R + w (R_target − R), with
//
//   R_target = target · (mean R / value of the key)^texture
//   w        = strength · selection · matte
//
// The including kernel defines the selection.
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
  uvec2 size;
  float texture_kept;
  float tolerance;
  float value_tolerance;
  float fall_off;  // 1 / softness
  int clusters;    // how many there are
  int cluster;     // the one to recolor
  uint first_row;
} push;

// Mean reflectance below which values are not distinguished: a coal cellar has 0.02.
const float kValueFloor = 1e-3;

void recolor(uint n, vec4 layers, float selection, float key_value) {
  if (MATTE) selection *= min(finite(FETCH(mask, int(n))).x, 1.0);
  if (PUBLISH) STORE(published, BY_ROWS(n), vec4(selection, 0.0, 0.0, 0.0));
  float ratio = (mean3(layers.rgb) + kValueFloor) / key_value;
  vec3 target = push.target.rgb * exp(push.texture_kept * log(ratio));
  vec3 changed = min(layers.rgb + push.target.w * selection * (target - layers.rgb), vec3(kLargest));
  STORE(edited, BY_ROWS(n), vec4(changed, layers.w));
}
