// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "global/model/model.glsl"

// One workgroup: the color of the lamps, the sixth-power mean of the grid's colors (shades of gray: Finlayson and
// Trezzi 2004), mixed with that of before; and the lamps' layer.
PLANE_IN(0, colors);
PLANE_INOUT(1, scene);
PLANE_OUT(2, lamp);
layout(push_constant) uniform Push {
  int count;    // of points
  float share;  // of the color to remove
} push;

void main() {
  vec4 sum = vec4(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < push.count; i += int(gl_WorkGroupSize.x)) {
    vec4 color = FETCH(colors, i);
    vec3 square = color.rgb * color.rgb;
    if (color.w > 0.0) sum.rgb += square * square * square;
  }
  sum = workgroup_sum(sum) / float(push.count);
  if (gl_LocalInvocationID.x > 0u) return;
  vec2 seen = push.share * chroma_of(pow(max(sum.rgb, 1e-30), vec3(1.0 / 6.0)));
  vec2 white = mix(LOAD(scene, SCENE_WHITE).xy, seen, LOAD(scene, SCENE_TIME)[TIME_SHARE]);
  LOAD(scene, SCENE_WHITE).xy = white;
  STORE(lamp, 0, vec4(color_of(white), 1.0));
}
