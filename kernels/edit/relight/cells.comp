// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/finite.glsl"
#include "relight.glsl"

// Log shading of cells of factor x factor pixels, followed over time: small changes are smoothed, large ones taken at once.
PLANE_IN(0, intrinsic);
SCALAR_INOUT(1, cells);
layout(push_constant) uniform Push {
  uvec2 size;   // in cells
  uvec2 frame;  // in pixels
  uint factor;
  uint fresh;  // 1: forget the frames before
} push;

const float kFollow = 0.2;                    // share of the way to the measurement, a frame, if it is near
const float kSmall = 0.1, kLargeChange = 0.5;  // ln S

void main() {
  uvec2 at = gl_GlobalInvocationID.xy;
  if (at.x >= push.size.x || at.y >= push.size.y) return;
  uvec2 first = at * push.factor, end = min(first + push.factor, push.frame);
  float sum = 0.0;
  for (uint y = first.y; y < end.y; ++y)
    for (uint x = first.x; x < end.x; ++x)
      sum += log(max(finite(FETCH(intrinsic, int(y * push.frame.x + x))).w, kShadingFloor));
  float now = sum / float((end.x - first.x) * (end.y - first.y));
  uint n = at.y * push.size.x + at.x;
  if (push.fresh == 0u) {
    float before = LOAD(cells, n);
    now = mix(before, now, mix(kFollow, 1.0, smoothstep(kSmall, kLargeChange, abs(now - before))));
  }
  STORE(cells, n, now);
}
