// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "recolor.glsl"

// Recolors what the mask selects.
PLANE_IN(4, key);  // mask_key.comp

void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y * kRows);
  if (at.x >= push.size.x) return;
  float key_value = mean3(FETCH(key, 0).rgb) + kValueFloor;
  uint last = min(at.y + kRows, push.size.y);
  for (uint y = at.y; y < last; ++y) {
    uint n = y * push.size.x + at.x;
    recolor(n, finite(FETCH(intrinsic, int(n))), 1.0, key_value);
  }
}
