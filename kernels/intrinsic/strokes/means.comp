// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "intrinsic/energy/energy.glsl"
#include "intrinsic/guide/guide.glsl"
#include "image/strokes/strokes.glsl"

// The value prior's mean target in every stroke, weighted by share and v: V of a stroke of constant shading, V - M of constant
// reflectance. A workgroup has a stroke.
PLANE_IN(0, cell_mask);
PLANE_IN(1, strokes);
PLANE_IN(2, cells);
PLANE_IN(3, value);
PLANE_OUT(4, means);  // .x of a stroke
layout(push_constant) uniform Push { uvec2 size; } push;  // of the cells

void main() {
  int stroke = int(gl_WorkGroupID.x);
  uvec4 bounds = uvec4(FETCH(strokes, STROKE_STRIDE * stroke + STROKE_BOUNDS));
  bool reflectance = FETCH(strokes, STROKE_STRIDE * stroke + STROKE_KIND).x == float(KIND_REFLECTANCE);
  uint packs = PACK4(push.size.x), first = bounds.x / 4u, columns = PACK4(bounds.z) - first, rows = bounds.w - bounds.y;
  uint apart = rows_apart(columns, rows);
  rows = (rows + apart - 1u) / apart;
  vec4 sum = vec4(0.0);
  for (uint i = gl_LocalInvocationIndex; i < columns * rows; i += gl_WorkGroupSize.x) {
    uint x = first + i % columns, y = bounds.y + apart * (i / columns);
    int at = int(y * packs + x);
    vec4 mask = FETCH(cell_mask, at), w = mix(vec4(0.0), weight_of(mask), equal(number_of(mask), vec4(stroke + 1)));
    if (all(equal(w, vec4(0.0)))) continue;
    vec4 target = FETCH(value, VALUE_STRIDE * at + VALUE_TARGET);
    w *= FETCH(value, VALUE_STRIDE * at + VALUE_WEIGHT);
    if (reflectance)
      for (uint k = 0u; k < 4u; ++k)
        target[k] -= FETCH(cells, CELL_STRIDE * int(y * push.size.x + min(4u * x + k, push.size.x - 1u))).x;
    sum.xy += vec2(dot(w, target), dot(w, vec4(1.0)));
  }
  sum = workgroup_sum(sum);
  if (gl_LocalInvocationIndex == 0u) STORE(means, uint(stroke), vec4(sum.y > 0.0 ? sum.x / sum.y : 0.0));
}
