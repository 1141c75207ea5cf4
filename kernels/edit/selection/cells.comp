// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/finite.glsl"
#include "oklab.glsl"

// The mean of each cell of side x side pixels: the frame's light, and reflectance as an Oklab color.
layout(constant_id = 1) const bool COLORS = true;
PLANE_IN(0, reflectance);
PLANE_IN(1, frame);
PLANE_OUT(2, light);
PLANE_OUT(3, colors);
layout(push_constant) uniform Push {
  uvec2 size;   // of the frame
  uvec2 cells;
  uint side;
} push;

void main() {
  uvec2 cell = gl_GlobalInvocationID.xy;
  if (cell.x >= push.cells.x) return;
  uvec2 first = cell * push.side, last = min(first + push.side, push.size);
  vec3 seen = vec3(0.0), paint = vec3(0.0);
  for (uint y = first.y; y < last.y; ++y)
    for (uint x = first.x; x < last.x; ++x) {
      int n = int(y * push.size.x + x);
      seen += finite(FETCH(frame, n)).rgb;
      if (COLORS) paint += finite(FETCH(reflectance, n)).rgb;
    }
  float count = float((last.x - first.x) * (last.y - first.y));
  uint n = cell.y * push.cells.x + cell.x;
  STORE(light, n, vec4(seen / count, 0.0));
  if (COLORS) STORE(colors, n, vec4(oklab(paint / count), 0.0));
}
