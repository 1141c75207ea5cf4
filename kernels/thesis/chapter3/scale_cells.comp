// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Writes the solution's cells for ScaleNormalization (scale.glsl), and the scale that the palette's histogram asks for. One
// cell of 4 x 4 pixels an invocation.
PLANE_IN(0, solution);
SCALAR_IN(1, palette_scale);
PLANE_OUT(2, cells);
PLANE_OUT(3, target);
layout(push_constant) uniform Push { uvec2 size; } push;  // of the solution

void main() {
  uvec2 cell = gl_GlobalInvocationID.xy, first = 4u * cell;
  uint columns = (push.size.x + 3u) / 4u;
  if (cell.x >= columns) return;
  uvec2 count = min(push.size - first, uvec2(4u));
  vec4 sum = vec4(0.0);
  for (uint y = 0u; y < count.y; ++y)
    for (uint x = 0u; x < count.x; ++x) sum += FETCH(solution, int((first.y + y) * push.size.x + first.x + x));
  sum /= float(count.x * count.y);
  // What is visible of a color is its mean channel.
  vec3 reflectance = exp(sum.rgb);
  STORE(cells, cell.y * columns + cell.x,
        vec4((sum.r + sum.g + sum.b) / 3.0 + sum.a, 0.8660254 * (sum.r - sum.g), 0.5 * (sum.r + sum.g) - sum.b,
             log((reflectance.r + reflectance.g + reflectance.b) / 3.0)));
  if (cell.x + cell.y == 0u) STORE(target, 0, vec4(FETCH1(palette_scale, 0), 1.0, 0.0, 0.0));
}
