// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "global/model/model.glsl"

// Draws every pixel in its base color; gray if the scene has none.
PLANE_IN(0, frame);
PLANE_IN(1, tints);
WORD_IN(2, slots);
PLANE_IN(3, scene);
PLANE_IN(4, light_state);  // light.glsl
PLANE_OUT(5, picture);
layout(push_constant) uniform Push {
  SIZES
  uint first_row;
} push;

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, push.first_row);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  vec2 tint;
  TINT_AT(tint, tints, at)
  vec3 white = color_of(FETCH(scene, SCENE_WHITE).xy);
  int label = int(FETCH1(slots, bin_of(chroma_of(in_white_light(sanitize(FETCH(frame, n).rgb) / white, FETCH(light_state, LIGHT_NOW))) - tint)));
  vec4 base = FETCH(scene, SCENE_COLORS + min(label, kSlots - 1));
  vec3 color = color_of(base.xy);
  bool known = FETCH(scene, SCENE_AMOUNT)[AMOUNT_COLORS] > 0.0 && base[COLOR_USED] > 0.0;
  STORE(picture, BY_ROWS(n), vec4(known ? color / max(color.r, max(color.g, color.b)) : vec3(0.5), 1.0));
}
