// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "key.glsl"

// The foreground's light without the screen's, with straight alpha, or (OVER_BLACK) over black.
layout(constant_id = 1) const bool OVER_BLACK = false;
layout(constant_id = 2) const bool EDITED = false;
layout(constant_id = 3) const bool INVERT = false;  // the screen stays, with all light on it
PLANE_IN(0, frame);
PLANE_IN(1, composed);  // the frame with its edits
PLANE_IN(2, behind);
PLANE_IN(3, front);
PLANE_IN(4, matte);   // x: the screen's share of the light is 1 - x
PLANE_IN(5, shrunk);  // x: alpha that goes out
PLANE_OUT(6, picture);
layout(push_constant) uniform Push {
  uvec2 size;
  uvec2 cells;
  float per_cell;
  float despill;
  uint first_row;
} push;

const float kAlphaMin = 0.05;  // alpha from which on a foreground's own light exceeds noise

void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y * kRows);
  if (at.x >= push.size.x) return;
  uint last = min(at.y + kRows, push.size.y);
  for (uint y = at.y; y < last; ++y) {
    int n = int(y * push.size.x + at.x);
    Place place = place_of(uvec2(at.x, y), push.cells, push.per_cell);
    vec4 input_light = finite(FETCH(frame, n)), back = AROUND(behind, place), near = AROUND(front, place);
    vec3 seen = min(input_light.rgb, vec3(kBrightest)), drawn = seen;
    float alpha = FETCH(matte, n).x;
    if (back.w > 0.0) {
      float added = kAlphaMin * (1.0 - alpha);
      vec3 other = near.w > 0.0 ? near.rgb : vec3(mean3(seen));
      drawn = max(seen - (1.0 - alpha) * back.rgb + added * other, vec3(0.0)) / max(alpha + added, 1e-3);
      vec3 q = chroma(back.rgb);
      if (length(q) > 1e-5) {
        vec3 d = normalize(q);
        drawn = max(drawn - push.despill * max(excess(drawn, d), 0.0) * d, vec3(0.0));
      }
    }
    if (INVERT) drawn = seen;
    if (EDITED) drawn *= min((finite(FETCH(composed, n)).rgb + kLightFloor) / (seen + kLightFloor), vec3(kBrightest));
    float shown = FETCH(shrunk, n).x * min(input_light.w, 1.0);
    STORE(picture, BY_ROWS(n), vec4(min(drawn, vec3(kBrightest)) * (OVER_BLACK ? shown : 1.0), shown));
  }
}
