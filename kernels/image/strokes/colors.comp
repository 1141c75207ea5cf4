// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "image/pack4.glsl"
#include "strokes.glsl"

// The mean reflectance in every stroke; w: 1, or 0 if it covers nothing. A workgroup has a stroke.
PLANE_IN(0, mask);
PLANE_IN(1, strokes);
PLANE_IN(2, reflectance);
PLANE_OUT(3, colors);
layout(push_constant) uniform Push { uvec2 size; } push;  // of the frame

void main() {
  int stroke = int(gl_WorkGroupID.x);
  uvec4 bounds = uvec4(FETCH(strokes, STROKE_STRIDE * stroke + STROKE_BOUNDS));
  uint packs = PACK4(push.size.x), rows = min(4u * bounds.w, push.size.y) - min(4u * bounds.y, push.size.y), columns = bounds.z - bounds.x;
  uint apart = rows_apart(columns, rows);
  rows = (rows + apart - 1u) / apart;
  vec4 sum = vec4(0.0);
  for (uint i = gl_LocalInvocationIndex; i < columns * rows; i += gl_WorkGroupSize.x) {
    uint x = bounds.x + i % columns, y = 4u * bounds.y + apart * (i / columns);  // a cell is as wide as a pack
    vec4 here = FETCH(mask, int(y * packs + x)), w = mix(vec4(0.0), weight_of(here), equal(number_of(here), vec4(stroke + 1)));
    for (uint k = 0u; k < 4u; ++k)
      if (w[k] > 0.0) sum += w[k] * vec4(FETCH(reflectance, int(y * push.size.x + 4u * x + k)).rgb, 1.0);
  }
  sum = workgroup_sum(sum);
  if (gl_LocalInvocationIndex == 0u) STORE(colors, uint(stroke), sum.w > 0.0 ? sum / sum.w : vec4(0.0));
}
