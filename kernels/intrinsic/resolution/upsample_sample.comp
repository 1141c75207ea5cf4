// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/guide/guide.glsl"
#include "image/pack4.glsl"
#include "upsample.glsl"

// Samples for the fit of the lines: (mean m of the up to 2 x 2 pixels, log shading). One half-size pixel an invocation.
PLANE_IN(0, frame);
PLANE_IN(1, intrinsic);  // of the half-size frame: R.rgb, S
PLANE_OUT(2, samples);
layout(push_constant) uniform Push { uvec2 size; } push;  // of the frame

void main() {
  uvec2 half_size = (push.size + 1u) / 2u, at = grid_position(half_size.x);
  if (at.y >= half_size.y) return;
  float sum = 0.0;
  for (uint k = 0u; k < 4u; ++k) {
    uvec2 from = min(2u * at + uvec2(k & 1u, k >> 1u), push.size - 1u);
    sum += mean_log(sanitize(FETCH(frame, int(from.y * push.size.x + from.x)).rgb));
  }
  uint pixel = at.y * half_size.x + at.x;
  STORE(samples, pixel, vec4(0.25 * sum, max(log(FETCH(intrinsic, int(pixel)).w), kDarkest), 0.0, 0.0));
}
