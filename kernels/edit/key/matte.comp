// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "key.glsl"

// The matte of every pixel, and the reflectance of what is behind those that are partly covered, minus theirs.
layout(constant_id = 1) const bool MATTE = false;  // the screen counts only where the mask selects
layout(constant_id = 2) const bool INVERT = false;  // the matte of the screen
PLANE_IN(0, frame);
PLANE_IN(1, intrinsic);
PLANE_IN(2, behind);
PLANE_IN(3, front);
PLANE_IN(4, mask);
PLANE_OUT(5, matte);
layout(push_constant) uniform Push {
  uvec2 size;
  uvec2 cells;
  float per_cell;  // 1 / side
  float black;
  float white;
  float strength;
  uint first_row;
} push;

void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y * kRows);
  if (at.x >= push.size.x) return;
  uint last = min(at.y + kRows, push.size.y);
  for (uint y = at.y; y < last; ++y) {
    int n = int(y * push.size.x + at.x);
    Place place = place_of(uvec2(at.x, y), push.cells, push.per_cell);
    vec3 seen = bounded(FETCH(frame, n)).rgb;
    vec4 back = AROUND(behind, place), near = AROUND(front, place), hidden = INVERT ? near : back;
    float alpha = clamp((opacity(seen, back, near) - push.black) / max(push.white - push.black, 1e-3), 0.0, 1.0);
    vec3 delta = vec3(0.0);
    if (alpha > 0.0 && alpha < 1.0 && hidden.w > 0.0) {
      vec3 paint = bounded(FETCH(intrinsic, n)).rgb;
      delta = min(paint * hidden.rgb / max(seen, vec3(1e-4)), vec3(4.0)) - paint;
    }
    float share = push.strength * (MATTE ? min(finite(FETCH(mask, n)).x, 1.0) : 1.0);
    float clear = share * (1.0 - alpha);
    STORE(matte, BY_ROWS(n), vec4(INVERT ? clear : 1.0 - clear, delta));
  }
}
