// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"

// Smooths log intensity and chroma of cells (scale.glsl), binomial weights over 5 x 5 cells: cells are coarser than print on
// paper, and a moving window of what is left of it matches nowhere. One cell an invocation.
PLANE_IN(0, cells);
PLANE_OUT(1, smoothed);
layout(push_constant) uniform Push { uvec2 size; } push;

void main() {
  ivec2 at = ivec2(grid_position(push.size.x)), last = ivec2(push.size) - 1;
  if (at.y > last.y) return;
  const float weights[5] = float[](0.0625, 0.25, 0.375, 0.25, 0.0625);
  vec3 sum = vec3(0.0);
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) {
      ivec2 p = clamp(at + ivec2(x, y), ivec2(0), last);
      sum += weights[x + 2] * weights[y + 2] * FETCH(cells, p.y * int(push.size.x) + p.x).xyz;
    }
  int i = at.y * int(push.size.x) + at.x;
  STORE(smoothed, i, vec4(sum, FETCH(cells, i).w));
}
