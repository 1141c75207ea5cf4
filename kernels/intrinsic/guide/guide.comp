// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"
#include "intrinsic/light_color/white_light.glsl"

// The guide's levels 0 and 1 from the frame, with kColored of the frame as it were in white light: one level-1 cell, 2 x 2 pixels, an
// invocation.
layout(constant_id = 1) const bool kColored = false;
PLANE_IN(0, frame);
PLANE_IN(1, light);  // light.glsl
PLANE_OUT(2, fine);
PLANE_OUT(3, coarse);
layout(push_constant) uniform Push { uvec2 size; } push;

void main() {
  uvec2 cells = (push.size + 1u) / 2u, cell = grid_position(cells.x);
  if (cell.y >= cells.y) return;
  vec4 sum = vec4(0.0), now = kColored ? FETCH(light, LIGHT_NOW) : vec4(0.0);
  for (uint k = 0u; k < 4u; ++k) {
    uvec2 at = min(2u * cell + uvec2(k & 1u, k >> 1u), push.size - 1u);
    uint pixel = at.y * push.size.x + at.x;
    vec3 rgb = sanitize(FETCH(frame, int(pixel)).rgb);
    float m = mean_log(rgb);
    if (kColored) rgb = in_white_light(rgb, m, now);
    vec4 guide = guide_of(rgb, m);
    STORE(fine, pixel, guide);
    sum += guide;
  }
  STORE(coarse, cell.y * cells.x + cell.x, 0.25 * sum);
}
