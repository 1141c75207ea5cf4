// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "guided.glsl"

// Local linear regression at each point: layer = slope * guide + offset, regularized with the noise variance, which
// grows with light (He, Sun and Tang, Guided Image Filtering, 2010). The slope is 0 if the layer does not follow the
// guide, and 1 if it follows it entirely.
PLANE_IN(0, points);   // guide, layer, 0, mask
PLANE_OUT(1, result);  // slope, offset, 0, kNone beside the object
layout(push_constant) uniform Push { int side; } push;

const float kDarkest = 0.02;  // where noise no longer falls with light

void main() {
  int i = int(line_index());
  if (i >= push.side * push.side) return;
  vec2 sum = vec2(0.0), square = vec2(0.0);
  float count = 0.0;
  bool counts = FETCH(points, i).w != 0.0;
  ivec4 window = around(i, push.side);
  for (int y = window.y; y <= window.w; ++y)
    for (int x = window.x; x <= window.z; ++x) {
      vec4 point = FETCH(points, y * push.side + x);
      sum += point.xy;
      square += point.x * point.xy;
      count += point.w;
    }
  vec2 mean = sum / max(count, 1.0), spread = square / max(count, 1.0) - mean.x * mean;
  float slope = clamp(spread.y / (max(spread.x, 0.0) + kNoise * max(mean.x, kDarkest)), 0.0, 1.0);
  STORE(result, i, vec4(slope, mean.y - slope * mean.x, 0.0, counts ? 0.0 : kNone));
}
