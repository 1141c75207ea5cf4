// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "image/pack4.glsl"
#include "image/strokes/strokes.glsl"

// How far the solution is from one value in every stroke: sums of w, w v and w v^2 over its pixels, v = s in a stroke of
// constant shading and m - s of constant reflectance, less its value at one place, so that little is lost by rounding. A workgroup
// has a stroke.
PLANE_IN(0, mask);
PLANE_IN(1, strokes);
PLANE_IN(2, level0);
PLANE_IN(3, shading);
PLANE_OUT(4, residuals);
#define RESIDUAL_WEIGHT 0
#define RESIDUAL_SUM 1
#define RESIDUAL_SQUARES 2
layout(push_constant) uniform Push { uvec2 size; } push;  // of the frame

// v of a pack of pixels.
vec4 value_at(uint x, uint y, bool reflectance) {
  vec4 v = FETCH(shading, int(y * PACK4(push.size.x) + x));
  if (reflectance)
    for (uint k = 0u; k < 4u; ++k)
      v[k] = FETCH(level0, int(y * push.size.x + min(4u * x + k, push.size.x - 1u))).x - v[k];
  return v;
}

void main() {
  int stroke = int(gl_WorkGroupID.x);
  uvec4 bounds = uvec4(FETCH(strokes, STROKE_STRIDE * stroke + STROKE_BOUNDS));
  bool reflectance = FETCH(strokes, STROKE_STRIDE * stroke + STROKE_KIND).x == float(KIND_REFLECTANCE);
  uint packs = PACK4(push.size.x), rows = min(4u * bounds.w, push.size.y) - 4u * bounds.y, columns = bounds.z - bounds.x;
  uint apart = rows_apart(columns, rows);
  rows = (rows + apart - 1u) / apart;
  float place = value_at(bounds.x, 4u * bounds.y, reflectance).x;
  vec4 sum = vec4(0.0);
  for (uint i = gl_LocalInvocationIndex; i < columns * rows; i += gl_WorkGroupSize.x) {
    uint x = bounds.x + i % columns, y = 4u * bounds.y + apart * (i / columns);  // a cell is as wide as a pack
    int at = int(y * packs + x);
    vec4 here = FETCH(mask, at), w = mix(vec4(0.0), weight_of(here), equal(number_of(here), vec4(stroke + 1)));
    if (all(equal(w, vec4(0.0)))) continue;
    vec4 v = value_at(x, y, reflectance) - place;
    sum += vec4(dot(w, vec4(1.0)), dot(w, v), dot(w, v * v), 0.0);
  }
  sum = workgroup_sum(sum);
  if (gl_LocalInvocationIndex == 0u) STORE(residuals, uint(stroke), sum);
}
