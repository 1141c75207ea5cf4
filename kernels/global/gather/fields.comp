// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "global/model/model.glsl"

// Light from surfaces of every base color at a surface of base color j around a coarse point, up to one factor: their part of what
// it receives, projected onto their color. And the base colors themselves.
PLANE_IN(0, blurred);
PLANE_IN(1, means);
PLANE_IN(2, received);
PLANE_IN(3, scene);
PLANE_OUT(4, fields);  // four base colors a vec4; four times the coarse grid for every j
PLANE_OUT(5, bases);
layout(push_constant) uniform Push {
  SIZES
  float near, own;
} push;

vec4 base_of(int k) {
  vec4 color = FETCH(scene, SCENE_COLORS + k);
  vec3 base = color_of(color.xy);
  return color[COLOR_USED] > 0.0 ? vec4(base / max(max(base.r, base.g), base.b), 1.0) : vec4(0.0);
}

void main() {
  int i = int(line_index()), count = push.coarse.x * push.coarse.y, slot = i / count, j = i - slot * count;
  if (slot >= kSlots) return;
  // As the lamps color it.
  if (i < kSlots) STORE(bases, i, vec4(color_of(FETCH(scene, SCENE_WHITE).xy), 1.0) * base_of(i));
  float number = FETCH(received, i).w;
  for (int q = 0; q < kSlots / 4; ++q) {
    vec4 amounts = vec4(0.0);
    for (int part = 0; part < 4; ++part) {
      int k = 4 * q + part;
      vec4 base = base_of(k);
      if (base.w == 0.0) continue;
      float seen = push.near * (k == slot ? 1.0 - push.own : 1.0) / number;
      vec3 from = seen * FETCH(blurred, k * count + j).rgb + (1.0 - push.near) * FETCH(means, k).rgb;
      amounts[part] = dot(base.rgb, from) / dot(base.rgb, base.rgb);
    }
    STORE(fields, (slot * (kSlots / 4) + q) * count + j, amounts);
  }
}
