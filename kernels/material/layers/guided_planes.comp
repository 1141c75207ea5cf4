// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "guided.glsl"

// As guided_lines.comp, in three channels: probability = slopes · color + offset. Points of probability 0 were masked
// out (drop_foreign.comp) or are clearly background; they are ignored.
PLANE_IN(0, points);   // color, probability
PLANE_OUT(1, result);  // slopes, offset or kNone
layout(push_constant) uniform Push { int side; } push;

void main() {
  int i = int(line_index());
  if (i >= push.side * push.side) return;
  vec4 mean = vec4(0.0);
  vec3 squares = vec3(0.0), products = vec3(0.0), along = vec3(0.0);  // rr gg bb, rg rb gb, with the probability
  float count = 0.0;
  ivec4 window = around(i, push.side);
  for (int y = window.y; y <= window.w; ++y)
    for (int x = window.x; x <= window.z; ++x) {
      vec4 point = FETCH(points, y * push.side + x);
      if (point.w == 0.0) continue;
      mean += point;
      squares += point.rgb * point.rgb;
      products += point.rrg * point.gbb;
      along += point.rgb * point.w;
      count += 1.0;
    }
  float share = 1.0 / max(count, 1.0);
  mean *= share;
  squares = max(share * squares - mean.rgb * mean.rgb, 0.0) + kNoise;
  products = share * products - mean.rrg * mean.gbb;
  along = share * along - mean.rgb * mean.w;
  // Elimination in a positive definite matrix: pivots are at least kNoise.
  float rg = products.x / squares.r, rb = products.y / squares.r;
  float g = max(squares.g - rg * products.x, kNoise), gb = (products.z - rg * products.y) / g;
  float b = max(squares.b - rb * products.y - gb * gb * g, kNoise);
  along.g -= rg * along.r;
  along.b -= rb * along.r + gb * along.g;
  vec3 slopes;
  slopes.b = along.b / b;
  slopes.g = along.g / g - gb * slopes.b;
  slopes.r = along.r / squares.r - rg * slopes.g - rb * slopes.b;
  bool counts = FETCH(points, i).w != 0.0;
  STORE(result, i, vec4(slopes, counts ? mean.w - dot(slopes, mean.rgb) : kNone));
}
