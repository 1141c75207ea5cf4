// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"
#include "strokes.glsl"

// The stroke that a pixel would be filled by, whose mean reflectance is nearest and nearer than kFillDistance, as w from 0 on; below
// 0: by none. A pixel of a stroke that is filled has that stroke's label. x: its weight, the larger the nearer.
PLANE_IN(0, mask);
PLANE_IN(1, strokes);
PLANE_IN(2, colors);
PLANE_IN(3, reflectance);
PLANE_OUT(4, labels);
WORD_OUT(5, claims);  // of no component
layout(push_constant) uniform Push {
  uvec2 size;  // of the frame
  int count;   // of the strokes
} push;

void main() {
  uvec2 at = gl_GlobalInvocationID.xy;
  if (at.x >= push.size.x) return;
  uint n = at.y * push.size.x + at.x;
  int own = int(FETCH(mask, int(at.y * PACK4(push.size.x) + at.x / 4u))[at.x & 3u]) - 1;
  float label = -1.0, nearest = kFillDistance;
  if (own >= 0) {
    if (FETCH(strokes, STROKE_STRIDE * own + STROKE_KIND)[STROKE_FILL] > 0.0) label = float(own);
    nearest = 0.0;
  } else {
    vec3 color = FETCH(reflectance, int(n)).rgb;
    for (int i = 0; i < push.count; ++i) {
      vec4 mean = FETCH(colors, i);
      float apart = distance(color, mean.rgb);
      if (mean.w > 0.0 && FETCH(strokes, STROKE_STRIDE * i + STROKE_KIND)[STROKE_FILL] > 0.0 && apart < nearest) {
        label = float(i);
        nearest = apart;
      }
    }
  }
  float part = min(2.0 * (1.0 - nearest / kFillDistance), 1.0);
  STORE(labels, n, vec4(part * part, 0.0, 0.0, label));
  STORE(claims, n, 0u);
}
